"""What the sandbox costs: the same gradings with and without it, alternately, in one run.

    .venv/bin/python tests/benchmarks/sandbox_cost.py [RUNS]

In the sandbox, kernels are forked from a process with all imports; without it, they are started.
Nothing is asserted: look at the ratio, because milliseconds depend on the machine.
"""

import statistics
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / 'tests')]

import nbformat
from sample_class import PATHS, assignment_of

from grader.course import Course
from grader.judging import execute as module
from grader.kernels.isolation import require_isolation
from grader.notebook.restore import restore
from grader.storage.pipeline import sanitize_restored
from grader.storage.registering import register

NAMES = (
    '02_joint_state-pass-numpy',
    '02_joint_state-fail-degrees',
    '03_publisher-pass-one_fifth',
    '03_publisher-fail-1hz',
)


def main(runs: int = 5) -> None:
    """Print the table."""
    require_isolation()  # its result is cached: without this, the first grading would include it
    course = Course(gradebook=Path(tempfile.mkdtemp(prefix='sandbox_cost-')))
    for assignment in course.assignments():
        register(course, assignment)
    print(f'{"median s per notebook":32}  sandboxed  not  ratio')
    ratios = []
    for name in NAMES:
        assignment = assignment_of(PATHS[name])
        submitted = nbformat.read(PATHS[name], as_version=4)
        restored = sanitize_restored(
            course, assignment, restore(submitted, course.template(assignment)).notebook
        )
        times: dict[bool, list[float]] = defaultdict(list)
        for run in range(runs):
            # the second one in a round has warmer caches
            for sandboxed in (True, False) if run % 2 else (False, True):
                module.require_isolation = lambda *, trust_students, answer=sandboxed: answer
                began = time.perf_counter()
                module.execute(restored)
                times[sandboxed].append(time.perf_counter() - began)
        ours, bare = (statistics.median(times[kind]) for kind in (True, False))
        ratios.append(ours / bare)
        print(f'{name:32}  {ours:9.2f} {bare:4.2f}  {ratios[-1]:5.2f}', flush=True)
    print(f'{"median of the ratios":32}  {statistics.median(ratios):21.2f}')


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
