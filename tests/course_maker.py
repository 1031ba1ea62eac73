"""Make a small course in a temporary folder: a lesson with two exercises, without a robot."""

import fcntl
import os
import shutil
from pathlib import Path

import nbformat
from given_verdicts import executed as executed  # most modules that make a course need it
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

from grader.authoring.release import release
from grader.course import ROOT, Course
from grader.storage.registering import register

TOY = '00_toy'
PIXEL = (
    'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk'
    'YPhfDwAChwGA60e6kgAAAABJRU5ErkJggg=='
)


def make_course(root: Path) -> Course:
    """Return a course in `root` whose only lesson is not released yet."""
    course = Course.at(root)
    course.root.mkdir(exist_ok=True)
    shutil.copy(ROOT / 'nbgrader_config.py', course.root)
    write_source(course, toy_lesson())
    return course


def released_course(root: Path) -> Course:
    """Return a course in `root` whose lesson is released and registered in its gradebook.

    Both take long and always give the same: they are done once per session, and copied.
    """
    shared = Path(os.environ['MY_ROBOT_BASICS_TESTS'])
    made = shared / 'released_course'
    with (shared / 'lock').open('w') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not made.exists():
            first = make_course(made.with_suffix('.part'))
            release(first)
            register(first, TOY)
            first.root.rename(made)
    shutil.copytree(made, root, dirs_exist_ok=True)
    return Course.at(root)


def with_own_database(released: Course, folder: Path) -> Course:
    """Return a released course with an empty gradebook in `folder`."""
    gradebook = folder / 'gradebook'
    gradebook.mkdir()
    shutil.copyfile(released.database, gradebook / released.database.name)
    return Course(root=released.root, gradebook=gradebook)


def add_lesson(course: Course, name: str) -> None:
    """Add a lesson with the same cells, registered in the gradebook but not released."""
    shutil.copytree(course.source_path(TOY).parent, course.root / 'solutions' / name)
    (course.root / 'solutions' / name / f'{TOY}.ipynb').rename(course.source_path(name))
    register(course, name)


def write_source(course: Course, lesson: NotebookNode) -> None:
    path = course.source_path(TOY)
    path.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(lesson, path)


def toy_lesson() -> NotebookNode:
    demo = new_code_cell('print("shown")', id='shown', metadata={'tags': ['demo']})
    demo.outputs = [
        new_output('stream', text='shown\n'),
        new_output('execute_result', {'text/plain': 'an arm', 'image/png': PIXEL}),
    ]
    demo.outputs[1].execution_count = demo.execution_count = 7
    demo.metadata['editor_noise'] = {'collapsed': True}
    setup = new_code_cell('from my_robot_basics.live import reset', id='setup')
    setup.outputs = [new_output('stream', text='noise\n')]
    return new_notebook(
        cells=[
            new_markdown_cell('# A toy', id='title'),
            setup,
            demo,
            _cell('double-reset', 'reset("double")', locked=True),
            _cell(
                'double',
                'def double(x):\n'
                '    """Return twice x."""\n'
                '    ### BEGIN SOLUTION\n'
                '    return x + x  # the secret answer\n'
                '    ### END SOLUTION',
                solution=True,
            ),
            new_code_cell('double(3)', id='try-it'),
            _cell('double-check', _check('Small numbers are doubled', 1), points=1),
            _cell(
                'double-hidden',
                f'{_check("Other numbers are doubled too", 0)}\n'
                '### BEGIN HIDDEN TESTS\n'
                'assert student.call("double", 21) == 42, "count again"  # hidden canary\n'
                '### END HIDDEN TESTS',
                points=2,
            ),
            _cell(
                'explain',
                'Because it is added to itself.',
                new=new_markdown_cell,
                points=2,
                solution=True,
            ),
        ],
        metadata={'widgets': {'noise': 1}, 'kernelspec': {'name': 'py99', 'display_name': 'Mine'}},
    )


def _check(title: str, number: int) -> str:
    return (
        f'"""{title}"""\n'
        'from my_robot_basics.checks import expect, student\n'
        f'seen = student.call("double", {number})\n'
        f'expect(seen == {2 * number}, expected={2 * number}, seen=seen, hint="add it to itself")'
    )


def answered(course: Course, answer: str, *, explained: str = '') -> NotebookNode:
    """Return the released lesson with an answer, as a student submits it."""
    notebook = course.release(TOY)
    by_id = {cell.id: cell for cell in notebook.cells}
    by_id['double'].source = answer
    if explained:
        by_id['explain'].source = explained
    return notebook


def submit(course: Course, student: str, notebook: NotebookNode | str | bytes) -> Path:
    path = course.folder('submitted', student, TOY) / f'{TOY}.ipynb'
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(notebook, NotebookNode):
        notebook = nbformat.writes(notebook)
    if isinstance(notebook, str):
        notebook = notebook.encode()
    path.write_bytes(notebook)
    return path


def _cell(
    grade_id: str,
    source: str,
    *,
    new: object = new_code_cell,
    points: float | None = None,
    solution: bool = False,
    locked: bool = False,
) -> NotebookNode:
    marks = {
        'grade': points is not None,
        'grade_id': grade_id,
        'locked': locked or (points is not None and not solution),
        'schema_version': 3,
        'solution': solution,
        'task': False,
    }
    if points is not None:
        marks['points'] = points
    return new(source, id=grade_id, metadata={'nbgrader': marks})
