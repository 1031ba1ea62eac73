"""The corpus of attacks against our grader and against stock nbgrader, attack by attack.

    .venv/bin/python tests/benchmarks/attacks_against_stock.py [--markdown] [ATTACK ...]

Each attack is handed in together with an honest neighbour, once to `./course grade` and once to
`nbgrader autograde` with its defaults, in a temporary course. Stock nbgrader does not protect
itself from student code. So all of it runs in one sandbox of ours, with its course, and is as
unprotected in there as on a machine of its own.

- points: the stored score, beside what honest work of that quality earns.
- told: the attacker's outputs contain text of a hidden test.
- spoiled: the neighbour's score is wrong, or a process, file or connection is left.

Nothing is asserted; the counts are at the end. The whole corpus takes some 45 minutes.
"""

import argparse
import asyncio
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / 'tests')]

import nbformat
from attacks.corpus import (
    CANARY,
    FULL,
    LEFT,
    NAMES,
    ROBOT,
    add_robot_lessons,
    assignment_of,
    attack,
    earns,
    hand_in_honestly,
)
from course_maker import TOY, make_course, toy_lesson, write_source

from grader.authoring.release import release
from grader.common.errors import RoomFailure
from grader.course import Course
from grader.grade import grade_all
from grader.sandbox.sandbox import Sandbox
from grader.storage.submitted import find_submissions

ATTACKER, NEIGHBOUR = 'a-attacker', 'b-neighbour'
PORT = 40_861
"""The port of the machine's own server, for attacks that try to connect to it."""
STOCK_LIMIT_SEC = 300.0
"""For two submissions; stock nbgrader itself stops a cell after half a minute."""
SLOT = 199
"""A slot that differs from all claimed ROS domains."""
STOCK_COURSE = Path('/room/home/course')
INSIDE = Path(__file__).with_name('stock_autograde.py')


@dataclass(frozen=True)
class Outcome:
    """The result of one attack."""

    points: float | None
    """None if nothing was stored."""
    told: bool = False
    spoiled: str = ''
    """What was left behind, or the neighbour's wrong score."""


def against_ours(name: str) -> Outcome:
    """Run an attack against our grader."""
    root = Path(tempfile.mkdtemp(prefix='attacked-'))
    try:
        course = _course(root)
        with socket.create_server(('127.0.0.1', 0)) as server:
            server.setblocking(False)
            _hand_in(course, name, port=server.getsockname()[1], gradebook=course.gradebook)
            submissions = find_submissions(course)
            rows = {row.student_id: row.stored for row in grade_all(course, submissions)}
            try:
                server.accept()[0].close()
                knocked = True
            except BlockingIOError:
                knocked = False
        left = ['a file'] * any(Path('/tmp', each).exists() for each in LEFT)
        left += ['a connection'] * knocked
        points = {student: stored and stored.score for student, stored in rows.items()}
        return _outcome(name, points, course.folder('autograded', ATTACKER, ''), left)
    finally:
        shutil.rmtree(root)


def against_stock(name: str, template: Path) -> Outcome:
    """Run an attack against stock nbgrader, both in a sandbox."""
    root = Path(tempfile.mkdtemp(prefix='attacked-'))
    try:
        course = _course(root)
        _hand_in(course, name, port=PORT, gradebook=STOCK_COURSE)
        shutil.copytree(template, root / 'stock')
        submitted = course.gradebook / 'submitted'
        shutil.copytree(submitted, root / 'stock' / 'submitted', symlinks=True)
        told = asyncio.run(_in_a_sandbox(root / 'stock', assignment_of(name)))
        if told is None:
            return Outcome(None, spoiled='ended the grader, or did not end')
        autograded = root / 'autograded'
        for number, notebook in enumerate(told['notebooks']):
            autograded.joinpath(str(number)).mkdir(parents=True)
            autograded.joinpath(str(number), 'x.ipynb').write_text(notebook, encoding='utf-8')
        return _outcome(name, told['points'], autograded, told['left'])
    finally:
        shutil.rmtree(root)


def _course(root: Path) -> Course:
    course = make_course(root)
    lesson = toy_lesson()  # stock nbgrader starts the kernel that the lesson names
    lesson.metadata.kernelspec = {'name': 'python3', 'display_name': '', 'language': 'python'}
    write_source(course, lesson)
    release(course, TOY)
    add_robot_lessons(course)
    return course


def _hand_in(course: Course, name: str, *, port: int, gradebook: Path) -> None:
    attack(course, name, port=port, gradebook=gradebook, student=ATTACKER)
    hand_in_honestly(course, NEIGHBOUR, assignment_of(name))


def _outcome(
    name: str, points: dict[str, float | None], autograded: Path, left: list[str]
) -> Outcome:
    theirs = points.get(NEIGHBOUR)
    if theirs != FULL[assignment_of(name)]:
        left = [f'the neighbour has {_number(theirs)}', *left]
    return Outcome(points.get(ATTACKER), told=_tells(autograded), spoiled=', '.join(left))


def _tells(autograded: Path) -> bool:
    """Whether the outputs of a graded notebook contain text of a hidden test."""
    for path in autograded.glob('*/*.ipynb'):
        cells = nbformat.read(path, as_version=4).cells
        if CANARY in str([cell.get('outputs') for cell in cells]):
            return True
    return False


async def _in_a_sandbox(course: Path, assignment: str) -> dict | None:
    """Run stock nbgrader on a copy of a course; return None if it did not finish."""
    sandbox = Sandbox(slot=SLOT)
    try:
        await sandbox.open()
        paths = sandbox.paths('student')
        shutil.copytree(course, paths.files / 'course', symlinks=True)
        shutil.copy(INSIDE, paths.files)
        script = paths.inside / 'given' / 'files' / INSIDE.name
        process = await asyncio.create_subprocess_exec(
            *(*paths.prefix, sys.executable, '-P', str(script)),
            *(str(STOCK_COURSE), assignment, str(PORT)),
            env=paths.environment,
            pass_fds=paths.pass_fds,
            cwd='/',
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        try:
            async with asyncio.timeout(STOCK_LIMIT_SEC):
                said, _ = await process.communicate()
        except TimeoutError:
            return None
    finally:
        await sandbox.close()  # ends everything that still runs there
    await process.wait()
    try:
        return json.loads(said.splitlines()[-1])
    except (IndexError, ValueError):
        return None


def make_template(root: Path) -> Path:
    """Make stock nbgrader's course, with both lessons released by nbgrader itself."""
    template, ours = root / 'template', root / 'ours'
    ours.mkdir()
    course = _course(ours)
    for assignment, source in (
        (TOY, course.source_path(TOY)),
        (ROBOT, ROOT / 'solutions' / ROBOT / f'{ROBOT}.ipynb'),
    ):
        folder = template / 'source' / assignment
        folder.mkdir(parents=True)
        shutil.copy(source, folder)
        command = [sys.executable, '-P', '-m', 'nbgrader', 'generate_assignment', assignment]
        # nbgrader finds its environment's programs on PATH
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ['PATH']])
        subprocess.run(
            command, cwd=template, check=True, capture_output=True, env=os.environ | {'PATH': path}
        )
    return template


def _number(points: float | None) -> str:
    return 'no score' if points is None else f'{points:g}'


def rows_of(names: Iterable[str], template: Path) -> Iterable[tuple[str, Outcome, Outcome]]:
    """Yield each attack with its results against our grader and against stock nbgrader."""
    for name in names:
        try:
            ours = against_ours(name)
        except RoomFailure as error:
            ours = Outcome(None, spoiled=str(error))
        yield name, ours, against_stock(name, template)


def line(cells: Iterable[str], *, markdown: bool) -> str:
    """Return a line of the table."""
    if markdown:
        return '| ' + ' | '.join(cells) + ' |'
    widths = (34, 5, 8, 4, 10, 8, 4, 0)
    return ' '.join(f'{cell:{width}}' for cell, width in zip(cells, widths, strict=True)).rstrip()


def columns(outcome: Outcome) -> list[str]:
    """Return the cells of the table for one of the two graders."""
    return [_number(outcome.points), 'yes' if outcome.told else '', outcome.spoiled]


def counted(title: str, outcomes: dict[str, Outcome]) -> str:
    """Return the counts of one grader in a sentence."""
    unlike = {name for name, each in outcomes.items() if each.points != earns(name)}
    more = {name for name in unlike if (outcomes[name].points or 0.0) > earns(name)}
    lost = {name for name in unlike if outcomes[name].points is None}
    told = {name for name, each in outcomes.items() if each.told}
    spoiled = {name for name, each in outcomes.items() if each.spoiled}
    return (
        f'{title}: of {len(outcomes)} attacks {len(more)} earned more than their work is worth, '
        f'{len(lost)} got no score stored, {len(told)} were told of a hidden test, '
        f'{len(spoiled)} spoiled another grade or left something.'
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('attacks', nargs='*', metavar='ATTACK', choices=[[], *NAMES])
    parser.add_argument('--markdown', action='store_true')
    asked = parser.parse_args()
    heads = ('attack', 'earns', 'ours', 'told', 'spoiled', 'stock', 'told', 'spoiled')
    print(line(heads, markdown=asked.markdown))
    if asked.markdown:
        print(line(['---'] * len(heads), markdown=True))
    ours, stock = {}, {}
    with tempfile.TemporaryDirectory(prefix='stock-') as folder:
        template = make_template(Path(folder))
        for name, here, there in rows_of(asked.attacks or NAMES, template):
            ours[name], stock[name] = here, there
            cells = [name, f'{earns(name):g}', *columns(here), *columns(there)]
            print(line(cells, markdown=asked.markdown), flush=True)
    print()
    print(counted('Ours', ours))
    print(counted('Stock', stock))


if __name__ == '__main__':
    main()
