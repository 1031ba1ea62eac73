"""Print how long *Validate* takes for each lesson: answered right, not at all, and wrong.

.venv/bin/python tests/benchmarks/validate_time.py [--busy N] [--samples] [LESSON ...]
"""

import argparse
import contextlib
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from answered import LESSONS, ROOT, answered, read
from package_changes import write
from sample_class import package_of

ENDLESS = 'while True: pass'
BEGINS = re.compile(r'^( +)super\(\).__init__\(.*\)\n|^def \w+\(.*:\n( +)', re.MULTILINE)
"""Matches the line after which an answer's code runs: in a constructor or a function."""


def main() -> None:
    """Measure `./course validate`, including its start."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('lessons', nargs='*', metavar='LESSON', default=[])
    parser.add_argument('--busy', type=int, default=0, help='busy loops beside it')
    parser.add_argument('--samples', action='store_true', help='all wrong sample answers, too')
    options = parser.parse_args()
    print(f'{"lesson":16} {"answer":34} {"seconds":>8} {"of CPU":>7}')
    with busy_loops(options.busy):
        for lesson in options.lessons or LESSONS:
            longest_sec = max(measured(lesson, samples=options.samples))
            print(f'{lesson:16} {"longest":34} {longest_sec:8.1f}', flush=True)


def measured(lesson: str, *, samples: bool) -> Iterator[float]:
    """Print and yield the seconds for each answer to a lesson."""
    with tempfile.TemporaryDirectory() as folder:
        for name, notebook in notebooks(lesson, Path(folder), samples=samples):
            began, used_sec = time.monotonic(), cpu_sec()
            command = [ROOT / 'course', 'validate', notebook]
            if name == 'right':
                write(package_of(f'{lesson}-pass-usual'), notebook.parent)
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            took_sec, used_sec = time.monotonic() - began, cpu_sec() - used_sec
            *_, summary = (run.stdout or run.stderr).strip().splitlines()
            print(f'{lesson:16} {name:34} {took_sec:8.1f} {used_sec:7.1f}  {summary}', flush=True)
            yield took_sec


def notebooks(lesson: str, folder: Path, *, samples: bool) -> Iterator[tuple[str, Path]]:
    """Yield answers to a lesson, with a description of each."""
    right = {
        cell.id: cell.source
        for cell in read('solutions', lesson).cells
        if cell.cell_type == 'code' and cell.metadata.get('nbgrader', {}).get('solution')
    }
    yield 'right', answered(lesson, folder / 'right')
    yield 'none', ROOT / 'notebooks' / lesson / f'{lesson}.ipynb'
    endless = dict.fromkeys(right, ENDLESS)
    yield 'cell does not return', answered(lesson, folder / 'cell', **endless)
    called = {name: BEGINS.sub(endless_from_there, source) for name, source in right.items()}
    if called != right:
        yield 'code does not return when called', answered(lesson, folder / 'called', **called)
    if samples:
        for path in sorted((ROOT / 'tests' / 'submissions').rglob(f'{lesson}-fail-*.ipynb')):
            yield path.stem.removeprefix(f'{lesson}-fail-'), path


def endless_from_there(begins: re.Match[str]) -> str:
    """Return the matched line, followed by an endless loop."""
    if begins[1]:
        return f'{begins[0]}{begins[1]}{ENDLESS}\n'
    return f'{begins[0]}{ENDLESS}\n{begins[2]}'


@contextlib.contextmanager
def busy_loops(number: int) -> Iterator[None]:
    """Run this number of busy loops during the block."""
    loops = [subprocess.Popen([sys.executable, '-c', ENDLESS]) for _ in range(number)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def cpu_sec() -> float:
    """Return the CPU seconds of all ended child processes, including kernels."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == '__main__':
    main()
