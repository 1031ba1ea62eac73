"""Print how long *Validate* takes for each lesson, answered right.

.venv/bin/python tests/benchmarks/validate_time.py [LESSON ...]
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from answered import LESSONS, ROOT, answered


def main() -> None:
    """Measure `./course validate`, its start included."""
    print(f'{"lesson":20} {"seconds":>8}')
    for lesson in sys.argv[1:] or LESSONS:
        with tempfile.TemporaryDirectory() as folder:
            notebook = answered(lesson, Path(folder))
            began = time.monotonic()
            command = [ROOT / 'course', 'validate', notebook]
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            took_sec = time.monotonic() - began
        *_, summary = (run.stdout or run.stderr).strip().splitlines()
        print(f'{lesson:20} {took_sec:8.1f}  {summary}')


if __name__ == '__main__':
    main()
