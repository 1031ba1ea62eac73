"""How long each part of an exercise takes, with forked kernels and with started ones.

    .venv/bin/python tests/benchmarks/where_time_goes.py [RUNS]

It prints medians over all exercises of some sample answers, judged one after another in one run. A
part that two rooms do at the same time counts once, with the slower one's time. Nothing is
asserted.
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

from my_robot_basics.validate.verdicts import judging
from sample_class import PATHS, assignment_of

from grader.course import Course
from grader.judging import execute
from grader.kernels import fork_client, fork_servers
from grader.kernels.isolation import require_isolation
from grader.kernels.kernel_connection import KernelConnection
from grader.kernels.kernels import GradingKernel
from grader.kernels.provisioner import SandboxProvisioner
from grader.kernels.rooms import GradingRooms
from grader.notebook.restore import restore
from grader.sandbox.sandbox import Sandbox
from grader.storage.pipeline import sanitize_restored
from grader.storage.registering import register

NAMES = (
    '02_joint_state-pass-numpy',
    '03_publisher-pass-steady_clock_timer',
    '03_publisher-fail-1hz',
    '03_publisher-pass-own_thread_and_init',
)
WATCHED = {
    'open the sandbox': (Sandbox, 'open'),
    'build the room': (fork_client, '_built'),
    'fork the kernel': (fork_client, '_forked'),
    'IPython starts': (SandboxProvisioner, 'post_launch'),
    'connect to it': (KernelConnection, 'connect'),
    'student cells': (GradingRooms, 'run_student_cell'),
    'checks': (GradingRooms, 'run_check'),
    'end it all': (GradingRooms, '__aexit__'),
    'start a kernel': (GradingKernel, 'start'),
    'open the rooms': (GradingRooms, '__aenter__'),
    'all of it': (judging, '_try_plans'),
}
"""Parts, and the methods that are timed. The last three include other parts."""
PAIRED = ('build the room', 'fork the kernel', 'IPython starts', 'connect to it', 'start a kernel')

spent: dict[str, list[float]] = defaultdict(list)
"""The seconds that each call of a part took in this exercise."""
exercises: list[dict[str, float]] = []


def watch(part: str, owner: object, name: str) -> None:
    """Patch an asynchronous function to record how long it takes."""
    function: Callable[..., Awaitable] = getattr(owner, name)

    async def timed(*args: object, **kwargs: object) -> object:
        began = time.perf_counter()
        try:
            return await function(*args, **kwargs)
        finally:
            spent[part].append(time.perf_counter() - began)
            if part == 'all of it':
                exercises.append(parts())

    setattr(owner, name, timed)


def parts() -> dict[str, float]:
    """Return the seconds of each part of the exercise that has just ended, and forget them."""
    took = {part: sum(spent[part]) for part in WATCHED}
    for part in PAIRED:
        took[part] = sum(max(pair) for pair in zip(*[iter(spent[part])] * 2, strict=True))
    opened = took.pop('open the rooms')
    took['a message crosses'] = opened - took['open the sandbox'] - took.pop('start a kernel')
    known = (opened, took['student cells'], took['checks'], took['end it all'])
    took['what is left'] = took['all of it'] - sum(known)
    spent.clear()
    return took


def judge(course: Course) -> list[dict[str, float]]:
    """Return the seconds of each part, for each exercise of the samples."""
    exercises.clear()
    for name in NAMES:
        assignment = assignment_of(PATHS[name])
        submitted = nbformat.read(PATHS[name], as_version=4)
        restored = sanitize_restored(
            course, assignment, restore(submitted, course.template(assignment)).notebook
        )
        execute.execute(restored)
    return list(exercises)


def main(runs: int = 3) -> None:
    """Print the table."""
    require_isolation()  # its result is cached: without this, the first grading would include it
    course = Course(gradebook=Path(tempfile.mkdtemp(prefix='where_time_goes-')))
    for assignment in course.assignments():
        register(course, assignment)
    for part, (owner, name) in WATCHED.items():
        watch(part, owner, name)
    judge(course)  # starts the fork servers
    forked, started = [], []
    for _ in range(runs):
        fork_servers._unfit.clear()
        forked += judge(course)
        fork_servers._unfit.update(student='to compare', test='to compare')
        started += judge(course)
    print(f'median ms of {len(forked)} exercises   forked  started')
    for part in forked[0]:
        columns = (1000 * statistics.median(e[part] for e in each) for each in (forked, started))
        print(f'{part:27}  {"{:8.1f} {:8.1f}".format(*columns)}')


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
