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
"""Attacks in an answer: to the lesson that KINDS gives for their first word, or to the toy's."""
OTHERS = {
    name: function
    for name, function in vars(notebooks).items()
    if inspect.isfunction(function) and function.__module__ == notebooks.__name__
}
NAMES = [*ANSWERS, *OTHERS]
ROBOT, SERVICES = '03_publisher', '08_services'
ACTIONS, PARAMETERS = '09_actions', '11_parameters'
FULL = {TOY: 3.0, ROBOT: 5.0, SERVICES: 7.0, ACTIONS: 10.0, PARAMETERS: 5.0}
KINDS = {
    'robot': (ROBOT, 'five_hz', 'publisher.py'),
    'server': (SERVICES, 'ik_service', 'server.py'),
    'client': (SERVICES, 'ik_client', 'client.py'),
    'mover': (ACTIONS, 'move_arm_server', 'mover.py'),
    'sender': (ACTIONS, 'move_arm_client', 'sender.py'),
    'rate': (PARAMETERS, 'adjustable_rate', 'rate.py'),
    'arms': (PARAMETERS, 'two_arms', ''),
}
"""The lesson and the exercise that an attack answers, and the honest code that comes before it."""
HONEST = 'def double(x):\n    return x + x'
HONEST_ROBOT = FOLDER.parents[1] / 'submissions' / '03_publisher-pass-steady_clock_timer.ipynb'
CANARY = 'hidden canary'
"""A text in the toy lesson's hidden test."""
LEFT = ('loaded_by_the_grader', 'evil_kernel', 'slipped')
"""Files under /tmp that an attack would leave."""


def assignment_of(name: str) -> str:
    """Return the lesson that an attack is handed in for."""
    return _kind(name)[0]


def _kind(name: str) -> tuple[str, str, str]:
    return KINDS.get(name.partition('_')[0], (TOY, '', ''))


def earns(name: str) -> float:
    """Return the points that an attack earns with the honest code in it."""
    first = ANSWERS[name].read_text(encoding='utf-8').splitlines()[0] if name in ANSWERS else ''
    said = re.search(r'# earns (\d)', first)
    return float(said[1]) if said else 0.0


def source_of(name: str) -> str:
    """Return the code of an attack in an answer, appended to the honest code that it changes."""
    source = ANSWERS[name].read_text(encoding='utf-8')
    honest = _kind(name)[2]
    before = Path(__file__).with_name(honest).read_text(encoding='utf-8') if honest else ''
    return f'{before}\n\n{source}' if honest else source


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
    assignment, exercise, _ = _kind(name)
    source = source_of(name).replace('GRADEBOOK', str(gradebook or course.gradebook))
    hand_in(course, student, source.replace('PORT', str(port)), assignment, exercise)


def hand_in(
    course: Course, student: str, answer: str, assignment: str, exercise: str = ''
) -> None:
    """Hand in a lesson with one answer filled in; if it has several exercises, say which."""
    notebook = course.release(assignment)
    (cell,) = (
        cell
        for cell in notebook.cells
        if cell.cell_type == 'code'
        and cell.metadata.get('nbgrader', {}).get('solution')
        and cell.metadata.nbgrader.grade_id.startswith(exercise)
    )
    cell.source = answer
    path = course.folder('submitted', student, assignment) / f'{assignment}.ipynb'
    path.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, path)


def hand_in_honestly(course: Course, student: str, assignment: str = TOY) -> None:
    """Hand in an answer that earns all points."""
    if assignment == TOY:
        hand_in(course, student, HONEST, TOY)
        return
    path = course.folder('submitted', student, assignment) / f'{assignment}.ipynb'
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(HONEST_ROBOT.read_bytes())


def add_robot_lessons(course: Course) -> None:
    """Add the lessons with nodes to a course that has only the toy lesson."""
    for step in ('solutions', 'notebooks'):
        for lesson in (ROBOT, SERVICES, ACTIONS, PARAMETERS):
            (course.root / step / lesson).symlink_to(Path(__file__).parents[2] / step / lesson)
