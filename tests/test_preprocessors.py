"""Our two preprocessors, as nbgrader calls them."""

import asyncio

import nbformat
import pytest
from course_maker import TOY, answered, submit
from nbformat.v4 import new_code_cell
from stand_in import note_tasks

from grader.autograde.preprocessors import ExecuteRooms, RestoreSubmission
from grader.judging.task import GradingTask
from grader.notebook.restore import KEY, grade_id

ANSWER = 'def double(x): return 2 * x'


@pytest.fixture
def course(released, monkeypatch):
    monkeypatch.chdir(released.root)
    return released


def resources(course, step='submitted'):
    folder = course.folder(step, 'ada', TOY)
    at = {'student': 'ada', 'assignment': TOY, 'notebook': TOY, 'db_url': course.db_url}
    return {'nbgrader': at, 'metadata': {'path': str(folder), 'name': TOY}}


def restored(course, content):
    path = submit(course, 'ada', content)
    before = path.read_bytes()
    read = nbformat.v4.new_notebook()  # what nbgrader has read does not count
    notebook, _ = RestoreSubmission().preprocess(read, resources(course))
    assert path.read_bytes() == before
    return notebook


def test_restoring_puts_the_source_back_around_the_answers(course):
    submitted = answered(course, ANSWER)
    submitted.cells = [c for c in submitted.cells if c.id != 'double-check']
    notebook = restored(course, submitted)
    sources = {grade_id(c): c.source for c in notebook.cells if grade_id(c)}
    assert sources['double'] == ANSWER
    assert 'hidden canary' in sources['double-hidden']
    assert notebook.metadata[KEY].notes == ['the cell `double-check` was missing: it was put back']


HOSTILE = {
    'nbgrader is text': {'nbgrader': 'x'},
    'grade id is a list': {'nbgrader': {'grade_id': []}},
    'tags are a number': {'tags': 5},
    'skip-execution': {'tags': ['skip-execution']},
    'a forged verdict': {KEY: {'role': 'setup', 'outcome': 'passed'}},
    'our key is a list': {KEY: [1]},
}


@pytest.mark.parametrize('metadata', HOSTILE.values(), ids=HOSTILE)
def test_hostile_metadata_is_ignored(course, metadata):
    submitted = answered(course, ANSWER)
    expected = restored(course, submitted)
    for cell in submitted.cells:
        cell.metadata = nbformat.from_dict({'nbgrader': cell.metadata.get('nbgrader')} | metadata)
        if 'grade_id' not in str(cell.metadata):
            cell.metadata = nbformat.from_dict(metadata)
    notebook = restored(course, nbformat.writes(submitted))
    assert marked(notebook) == marked(expected)
    assert {str(c.metadata) for c in notebook.cells if not grade_id(c)} == {
        str(c.metadata) for c in expected.cells if not grade_id(c)
    }


def marked(notebook):
    return [c.metadata for c in notebook.cells if grade_id(c)]


def role_of(cell):
    return cell.metadata[KEY].role


@pytest.mark.parametrize(
    'content', ['', '{}', b'\xff' * 100], ids=['empty', 'no notebook', 'binary']
)
def test_an_unreadable_notebook_fails_all_checks_with_its_problem_as_reason(course, content):
    notebook = restored(course, content)
    assert TOY in notebook.metadata[KEY].problem
    executed, _ = ExecuteRooms().preprocess(notebook, resources(course, 'autograded'))
    graded = [c for c in executed.cells if role_of(c) == 'grade']
    assert {c.metadata[KEY].outcome for c in graded} == {'failed'}
    assert {c.outputs[-1].evalue for c in graded} == {notebook.metadata[KEY].problem}


@pytest.fixture
def tasks(monkeypatch):
    """What the second pass hands to the worker."""
    return note_tasks(monkeypatch, lambda notebook: notebook)


@pytest.mark.parametrize('in_a_loop', [False, True], ids=['command', 'formgrader'])
def test_execution_uses_the_students_seed_and_the_students_files(course, tasks, in_a_loop):
    folder = submit(course, 'ada', answered(course, ANSWER)).parent
    (folder / 'helper.py').write_text('')
    (folder / 'data.csv').write_text('')
    masters = course.folder('autograded', 'ada', TOY)  # what nbgrader puts there does not count
    masters.mkdir(parents=True, exist_ok=True)
    (masters / 'helper.py').write_text('of the instructor')
    notebook = nbformat.v4.new_notebook(cells=[new_code_cell('x')])

    async def formgrader():
        return ExecuteRooms().preprocess(notebook, resources(course, 'autograded'))

    at = resources(course, 'autograded')
    result = asyncio.run(formgrader()) if in_a_loop else ExecuteRooms().preprocess(notebook, at)
    assert result[0] is notebook
    assert tasks == [
        GradingTask(notebook=notebook, files={'helper.py': b''}, seed=course.seed(TOY, 'ada'))
    ]


def test_both_preprocessors_are_enabled():
    assert RestoreSubmission().enabled
    assert ExecuteRooms().enabled
