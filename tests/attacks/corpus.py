"""The attacks by name: how each is handed in, and what it earns."""

import inspect
import re
from pathlib import Path

import nbformat
from attacks import notebooks
from course_maker import TOY, submit

from grader.course import Course

FOLDER = Path(__file__).parent / 'answers'
ANSWERS = {path.stem: path for path in sorted(FOLDER.glob('*.py'))}
"""Attacks that are an answer; those that begin with `robot_` are one to lesson 3."""
PUBLISHER = Path(__file__).with_name('publisher.py')
"""What stands before those."""
OTHERS = {
    name: function
    for name, function in vars(notebooks).items()
    if inspect.isfunction(function) and function.__module__ == notebooks.__name__
}
NAMES = [*ANSWERS, *OTHERS]
ROBOT = '03_publisher'
FULL = {TOY: 3.0, ROBOT: 5.0}
HONEST = 'def double(x):\n    return x + x'
HONEST_ROBOT = FOLDER.parents[1] / 'submissions' / '03_publisher-pass-steady_clock_timer.ipynb'
CANARY = 'hidden canary'
"""Stands in the toy lesson's hidden test."""
LEFT = ('loaded_by_the_grader', 'evil_kernel', 'slipped')
"""Files under /tmp that an attack would leave."""


def assignment_of(name: str) -> str:
    """Return the lesson that an attack is handed in for."""
    return ROBOT if name.startswith('robot_') else TOY


def earns(name: str) -> float:
    """Return the points that an attack gets for the honest work in it."""
    first = ANSWERS[name].read_text(encoding='utf-8').splitlines()[0] if name in ANSWERS else ''
    said = re.search(r'# earns (\d)', first)
    return float(said[1]) if said else 0.0


def attack(
    course: Course, name: str, *, port: int, gradebook: Path | None = None, student: str = ''
) -> None:
    """Hand in one attack, that knows where the gradebook and a server of the machine are."""
    student = student or name
    if name in OTHERS:
        notebook = course.release(TOY)
        path = submit(course, student, notebook)
        OTHERS[name](notebook, path.parent)
        submit(course, student, notebook)
        return
    source = ANSWERS[name].read_text(encoding='utf-8')
    if assignment_of(name) == ROBOT:
        source = f'{PUBLISHER.read_text(encoding="utf-8")}\n\n{source}'
    source = source.replace('GRADEBOOK', str(gradebook or course.gradebook))
    hand_in(course, student, source.replace('PORT', str(port)), assignment_of(name))


def hand_in(course: Course, student: str, answer: str, assignment: str) -> None:
    """Hand in a lesson with one answer typed in."""
    notebook = course.release(assignment)
    (cell,) = (
        cell
        for cell in notebook.cells
        if cell.cell_type == 'code' and cell.metadata.get('nbgrader', {}).get('solution')
    )
    cell.source = answer
    path = course.folder('submitted', student, assignment) / f'{assignment}.ipynb'
    path.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, path)


def hand_in_honestly(course: Course, student: str, assignment: str = TOY) -> None:
    """Hand in what earns all points."""
    if assignment == TOY:
        hand_in(course, student, HONEST, TOY)
        return
    path = course.folder('submitted', student, assignment) / f'{assignment}.ipynb'
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(HONEST_ROBOT.read_bytes())


def add_robot_lesson(course: Course) -> None:
    """Let a course of the toy lesson have lesson 3, too."""
    for step in ('solutions', 'notebooks'):
        here = Path(__file__).parents[2] / step / ROBOT
        (course.root / step / ROBOT).symlink_to(here)
