"""Time per graded submission, compared with stock nbgrader on the same notebooks in the same run.

    .venv/bin/python tests/benchmarks/grading_time.py [RUNS]

Stock means nbgrader's own Execute: all cells in one kernel, with hidden tests, one submission
after another. It also runs the demonstrations of a lesson; the last columns leave them out.
Nothing is asserted: look at the ratios, because milliseconds depend on the machine.
"""

import statistics
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Awaitable, Callable
from pathlib import Path

import nbformat

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / 'tests')]

from nbgrader.preprocessors import Execute
from sample_class import PATHS, assignment_of, grade

from grader.course import Course
from grader.judging.execute import execute
from grader.kernels.kernels import GradingKernel
from grader.kernels.rooms import GradingRooms
from grader.notebook.restore import restore, role
from grader.storage.pipeline import sanitize_restored
from grader.storage.registering import register

NAMES = (
    '02_joint_state-pass-numpy',
    '02_joint_state-fail-degrees',
    '03_publisher-pass-one_fifth',
    '03_publisher-fail-1hz',
    '03_publisher-fail-degrees',
    '03_publisher-pass-sleep_loop',
)
PARTS = ('start', 'probe', 'student cells', 'checks', 'stop')

spent: dict[str, list[float]] = defaultdict(list)
"""The seconds that each call of a part took."""


def timed(part: str, method: Callable[..., Awaitable]) -> Callable[..., Awaitable]:
    """Return an asynchronous method that also records how long it takes."""

    async def and_timed(*args: object, **kwargs: object) -> object:
        began = time.perf_counter()
        try:
            return await method(*args, **kwargs)
        finally:
            spent[part].append(time.perf_counter() - began)

    return and_timed


def watch_the_rooms() -> None:
    """Patch the rooms so that each part of a grading is timed."""
    GradingKernel.start = timed('start', GradingKernel.start)
    GradingRooms.__aenter__ = timed('open', GradingRooms.__aenter__)
    GradingRooms.run_student_cell = timed('student cells', GradingRooms.run_student_cell)
    GradingRooms.run_check = timed('checks', GradingRooms.run_check)
    GradingRooms.__aexit__ = timed('stop', GradingRooms.__aexit__)


def seconds(work: Callable[..., object], *args: object) -> float:
    """Return how many seconds a call takes."""
    began = time.perf_counter()
    work(*args)
    return time.perf_counter() - began


def parts_of_one() -> dict[str, float]:
    """Return the seconds of each part since the last call, and forget them."""
    parts = {part: sum(spent[part]) for part in PARTS}
    # two kernels start at the same time; the rest of opening the rooms is the probe
    parts['start'] = sum(max(pair) for pair in zip(*[iter(spent['start'])] * 2, strict=True))
    parts['probe'] = sum(spent['open']) - parts['start']
    spent.clear()
    return parts


def without_demonstrations(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Return a copy of a notebook without its demonstrations."""
    shorter = nbformat.from_dict(notebook)
    shorter.cells = [cell for cell in shorter.cells if role(cell) != 'demo']
    return shorter


def main(runs: int = 3) -> None:
    """Print the tables."""
    course = Course(gradebook=Path(tempfile.mkdtemp(prefix='grading_time-')))
    for assignment in course.assignments():
        register(course, assignment)
    watch_the_rooms()
    rows, parts = [], defaultdict(list)
    for name in NAMES:
        assignment = assignment_of(PATHS[name])
        submitted = nbformat.read(PATHS[name], as_version=4)
        restored = sanitize_restored(
            course, assignment, restore(submitted, course.template(assignment)).notebook
        )
        shorter = without_demonstrations(restored)
        times: dict[str, list[float]] = defaultdict(list)
        for _ in range(runs):
            spent.clear()
            times['ours'].append(seconds(execute, restored))
            for part, sec in parts_of_one().items():
                parts[part].append(sec)
            times['stock'].append(seconds(stock, restored))
            times['shorter'].append(seconds(stock, shorter))
        rows.append((name, *(statistics.median(times[k]) for k in ('ours', 'stock', 'shorter'))))
        print_row(*rows[-1], first=len(rows) == 1)

    print('\nWhere our time goes, in s (median of all):')
    for part in PARTS:
        print(f'  {part:14} {statistics.median(parts[part]):6.2f}')

    began = time.perf_counter()
    grade(course, NAMES)
    each = (time.perf_counter() - began) / len(NAMES)
    print(f'\nAs `./course grade` does it, several at a time and stored: {each:.2f} s each;')
    print(f'stock, one by one, not stored: {statistics.mean(row[2] for row in rows):.2f} s each.')


def stock(notebook: nbformat.NotebookNode) -> None:
    """Run a copy of a notebook as stock nbgrader does."""
    Execute().preprocess(nbformat.from_dict(notebook), {})


def print_row(name: str, ours: float, stock: float, shorter: float, *, first: bool) -> None:
    """Print one line of the table, after its heading."""
    if first:
        print(f'{"median s per notebook":32}  ours  stock  ratio  stock, shorter  ratio')
    print(
        f'{name:32} {ours:5.2f}  {stock:5.2f}  {ours / stock:5.2f}  {shorter:14.2f}  '
        f'{ours / shorter:5.2f}',
        flush=True,
    )


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
