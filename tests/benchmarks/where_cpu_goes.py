"""Which processes use the CPU while a submission is graded, and in which part.

    .venv/bin/python tests/benchmarks/where_cpu_goes.py [RUNS] [--samples NAME ...]

It prints means over some right and wrong sample answers, or those that are named, graded one after
another: also how often checks ask the student's kernel. Waiting is not counted, so a busy machine
shows nearly the same; neither are the programs that kernels start. Nothing is asserted.
"""

import argparse
import asyncio
import os
import re
import resource
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from measuring import Course, new_course, table
from package_changes import write
from sample_class import PATHS, assignment_of, package_of

from grader.judging.execute import execute_exercises
from grader.kernels.isolation import require_isolation
from grader.kernels.kernels import GradingKernel
from grader.kernels.rooms import GradingRooms
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.storage.database import share_engine
from grader.storage.gradebook import store
from grader.storage.pipeline import make_sanitized_template
from grader.storage.registering import register

NAMES = (
    '02_joint_state-pass-one_constructor',
    '03_publisher-pass-one_fifth',
    '03_publisher-fail-degrees',
    '04_subscriber-pass-one_line',
    '07_common_errors-pass-helpers_and_one_message_object',
)
START, PROBE, REST = 'starts', 'probe', 'cells, and nodes meanwhile'
TICKS = os.sysconf('SC_CLK_TCK')

used: Counter[tuple[str, str]] = Counter()
"""Seconds of CPU time, by process and part."""
requests: list[str] = []
before: dict[int, float] = {}
"""The CPU seconds of each kernel at the last look, by process ID."""


def note(kernel: GradingKernel, part: str) -> None:
    """Add the CPU time that a kernel has used since the last look to a part."""
    provisioner = kernel._manager.provisioner
    if not kernel._manager.has_kernel or not hasattr(provisioner.process, '_kernel'):
        return
    about = Path(f'/proc/self/fdinfo/{provisioner.process._kernel}')
    try:
        pid = int(re.search(r'^Pid:\s+(-?\d+)', about.read_text('ascii'), re.MULTILINE)[1])
        fields = Path(f'/proc/{pid}/stat').read_text('utf-8').rpartition(')')[2].split()
    except FileNotFoundError:  # the kernel has ended
        return
    now = (int(fields[11]) + int(fields[12])) / TICKS
    used[f'{kernel.room} kernel', part] += now - before.get(pid, 0.0)
    before[pid] = now


def watch(name: str, part_of: Callable[..., str], *, first: bool = False) -> None:
    """Patch a method of kernels to record CPU time that it used, or, with `first`, before it."""
    method = getattr(GradingKernel, name)

    async def noted(kernel: GradingKernel, *args: object, **kwargs: object) -> object:
        if first:
            note(kernel, part_of())
        result = await method(kernel, *args, **kwargs)
        if not first:
            note(kernel, part_of(*args))
        return result

    setattr(GradingKernel, name, noted)


def count_requests() -> None:
    """Patch rooms to keep each request of a check to the student's kernel in `requests`."""
    ask = GradingRooms._ask_student

    async def counted(rooms: GradingRooms, request: str) -> str:
        requests.append(request)
        return await ask(rooms, request)

    GradingRooms._ask_student = counted


def grade(course: Course, name: str, number: int) -> None:
    """Grade a sample as a student's submission, and store it."""
    assignment, student = assignment_of(PATHS[name]), f'student_{number}'
    folder = course.folder('submitted', student, assignment)
    folder.mkdir(parents=True)
    (folder / f'{assignment}.ipynb').write_bytes(PATHS[name].read_bytes())
    write(package_of(name), folder)
    packages = [path for path in folder.iterdir() if path.is_dir()]
    template = make_sanitized_template(course, assignment)
    parts = [time.process_time()]
    submission = read_submission(folder, student_id=student, assignment=assignment)
    restored = restore(submission.notebook, template).notebook
    parts.append(time.process_time())
    graded = asyncio.run(execute_exercises(restored, extra_files=packages)).notebook
    parts.append(time.process_time())
    store(course, submission, graded)
    parts.append(time.process_time())
    names = (('run', 'read and restore'), ('worker', 'rooms and messages'), ('run', 'store'))
    for which, start, end in zip(names, parts, parts[1:], strict=False):
        used[which] += end - start


def main(runs: int, names: Sequence[str]) -> None:
    """Print the table."""
    require_isolation()
    course = new_course('cpu')
    for assignment in {assignment_of(PATHS[name]) for name in names}:
        register(course, assignment)
    watch('start', lambda *_: START)
    watch('run', lambda code, *_: PROBE if 'probe' in code else REST)
    watch('stop', lambda *_: REST, first=True)
    count_requests()
    with share_engine(course.db_url):
        grade(course, names[0], 0)  # starts the fork servers
        used.clear()
        requests.clear()
        children, number = _of_children(), 0
        for number, name in enumerate(runs * [*names], start=1):
            grade(course, name, number)
    used['bubblewrap and the like', 'rooms'] = _of_children() - children
    asked = len(requests) / number
    print(f'{number} submissions, {asked:g} requests each, load {os.getloadavg()[0]:.1f}')
    rows = [(who, part, 1000 * seconds / number) for (who, part), seconds in sorted(used.items())]
    total = 1000 * sum(used.values()) / number
    table(('', '', 'CPU ms each'), [*rows, ('all', '', total)])


def _of_children() -> float:
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('runs', type=int, nargs='?', default=3, metavar='RUNS')
    parser.add_argument('--samples', nargs='+', default=NAMES, metavar='NAME')
    args = parser.parse_args()
    main(args.runs, args.samples)
