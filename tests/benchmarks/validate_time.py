"""Print how long *Validate* takes for each lesson, answered right.

.venv/bin/python tests/benchmarks/validate_time.py [LESSON ...]
"""

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from answered import LESSONS, ROOT, answered


def main() -> None:
    """Measure `./course validate`, its start included."""
    print(f'{"lesson":20} {"seconds":>8} {"of CPU":>8}')
    for lesson in sys.argv[1:] or LESSONS:
        with tempfile.TemporaryDirectory() as folder:
            notebook = answered(lesson, Path(folder))
            began, used_sec = time.monotonic(), cpu_sec()
            command = [ROOT / 'course', 'validate', notebook]
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            took_sec, used_sec = time.monotonic() - began, cpu_sec() - used_sec
        *_, summary = (run.stdout or run.stderr).strip().splitlines()
        print(f'{lesson:20} {took_sec:8.1f} {used_sec:8.1f}  {summary}')


def cpu_sec() -> float:
    """How much of a processor all that was started here has used, kernels too."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == '__main__':
    main()
