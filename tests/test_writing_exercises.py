"""The example of docs/writing-exercises.md, released, answered and graded as the page tells."""

import re

import nbformat
import pytest
from course_maker import make_course
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from grader.__main__ import main
from grader.authoring.release import release
from grader.course import ROOT
from grader.grade import grade_all
from grader.storage.registering import register
from grader.storage.submitted import find_submissions

PAGE = (ROOT / 'docs/writing-exercises.md').read_text(encoding='utf-8')
CELL = re.compile(
    r'^\*\*`?([\w-]+)`?\*\*(?: · ([\w -]+?))?(?: · (\d+) points?)?\n\n```python\n(.*?)^```',
    re.MULTILINE | re.DOTALL,
)
LESSON = '00_toy'
RIGHT = 'float(number.data + number.data)'
ANSWERS = {
    'right': (RIGHT, {'doubler_node': 1, 'doubler_values': 2}),
    'wrong': ('number.data + 1.5', {'doubler_node': 1, 'doubler_values': 0}),
}
"""What each student publishes, and the points that the page says it earns."""


def example():
    """Return the lesson that the page's blocks make."""
    cells = [new_markdown_cell('# 0 · An example', id='title')]
    for name, kind, points, source in CELL.findall(PAGE):
        cell = new_code_cell(source.rstrip('\n'), id=name)
        if kind:
            cell.metadata.nbgrader = {
                'grade_id': name,
                'grade': bool(points),
                'solution': kind == 'Autograded answer',
                'locked': kind != 'Autograded answer',
                'task': False,
                'schema_version': 3,
            } | ({'points': int(points)} if points else {})
        cells.append(cell)
    return nbformat.from_dict(new_notebook(cells=cells))


def answer_of(source, published):
    """Return the answer cell's solution with another number published."""
    return re.sub(r' *###.*\n', '', source).replace('2.0 * number.data', published)


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    course = make_course(tmp_path_factory.mktemp('example'))
    nbformat.write(example(), course.source_path(LESSON))
    release(course)
    register(course, LESSON)
    return course


def test_the_page_has_every_cell_of_an_exercise():
    assert [name for name, *_ in CELL.findall(PAGE)] == [
        *('setup', 'doubler-reset', 'doubler', 'doubler-run', 'try'),
        *('doubler_node', 'doubler_values'),
    ]


@pytest.mark.starts  # to release takes long
def test_the_release_of_the_example_holds_no_answer_and_no_hidden_test(course):
    text = course.release_path(LESSON).read_text(encoding='utf-8')
    assert 'YOUR CODE HERE' in text
    assert 'check_number(1.5)' in text
    assert '2.0 * number.data' not in text
    assert 'uniform' not in text


@pytest.mark.slow
@pytest.mark.isolation
def test_answers_to_the_example_earn_the_points_stated_on_the_page(course):
    source = next(cell.source for cell in example().cells if cell.id == 'doubler')
    for student, (published, _) in ANSWERS.items():
        notebook = course.release(LESSON)
        (cell,) = (cell for cell in notebook.cells if cell.id == 'doubler')
        cell.source = answer_of(source, published)
        path = course.folder('submitted', student, LESSON) / f'{LESSON}.ipynb'
        path.parent.mkdir(parents=True)
        nbformat.write(notebook, path)
    rows = {row.student_id: row for row in grade_all(course, find_submissions(course))}
    assert {student: row.stored.score for student, row in rows.items()} == {
        student: sum(points.values()) for student, (_, points) in ANSWERS.items()
    }
    assert main(['scores'], course=course) == 0
    table = (course.gradebook / 'scores.csv').read_text(encoding='utf-8-sig')
    (told,) = re.findall(r'\*(in the part checked at grading: .+?)\*', PAGE.replace('\n', ' '))
    assert told in rows['wrong'].reason
    assert told in table
