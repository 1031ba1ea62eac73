import asyncio
import json
from types import SimpleNamespace

import nbformat
import pytest
from course_maker import executed as judged
from course_maker import toy_lesson

from grader.common.errors import TaskFailed
from grader.judging import task
from grader.judging.execute import Execution
from grader.judging.task import GradingTask, pack, run_packed, unpack
from grader.notebook.restore import KEY

ODD = 'lone \udcff, nul \0, ideographs 小明, escapes \x1b[31m, </script>'


@pytest.fixture
def work():
    return GradingTask(
        notebook=toy_lesson(), seed='abc', files={'helper.py': b'\xff\0', 'a b.py': b''}
    )


@pytest.fixture
def looked(monkeypatch):
    """What the rooms were given."""
    seen = {}

    async def look(notebook, *, extra_files, seed, trust_students):
        seen.update(files={p.name: p.read_bytes() for p in extra_files}, seed=seed)
        seen.update(folder=extra_files[0].parent, trusted=trust_students)
        notebook = judged(notebook, {'double-check': ODD})
        notebook.metadata[KEY] = {'notes': [], 'seed': seed}
        return Execution(notebook=notebook, verdicts=(), notes=())

    monkeypatch.setattr(task, 'execute_exercises', look)
    return seen


def do(text):
    return asyncio.run(run_packed(text))


def test_a_grading_task_and_its_result_survive_packing_as_text(work, looked, monkeypatch):
    times = iter((100.0, 107.5))
    monkeypatch.setattr(task, 'time', SimpleNamespace(monotonic=lambda: next(times)))
    text = pack(work)
    assert text.isascii()
    answer = do(text)
    assert answer.isascii()
    result = unpack(answer, work)
    assert result.notebook == graded_lesson(work, {'double-check': ODD})
    assert isinstance(result.notebook.cells[0].metadata, nbformat.NotebookNode)
    assert result.seconds == 7.5
    assert looked['files'] == work.files
    assert (looked['seed'], looked['trusted']) == ('abc', False)
    assert not looked['folder'].exists()


def toy_lesson_like(work):
    return nbformat.from_dict(json.loads(json.dumps(work.notebook)))


def graded_lesson(work, reasons):
    notebook = judged(toy_lesson_like(work), reasons)
    notebook.metadata[KEY] = nbformat.from_dict({'notes': [], 'seed': work.seed})
    return notebook


def test_running_a_packed_task_does_not_change_the_task(work, looked):
    text = pack(work)
    assert do(text) != text
    assert pack(work) == text


@pytest.mark.parametrize('path', ['../../up.py', '/up.py', 'a/../../up.py'])
def test_a_file_path_that_leaves_its_folder_is_refused(work, looked, path):
    sent = json.loads(pack(work))
    sent['files'] = {path: ''}
    with pytest.raises(TaskFailed, match='is not the path of a file in a submission'):
        unpack(do(json.dumps(sent)), work)
    assert looked == {}


def test_a_task_that_takes_too_long_is_given_up(work, monkeypatch):
    async def endless(notebook, **_):
        await asyncio.Event().wait()

    monkeypatch.setattr(task, 'execute_exercises', endless)
    monkeypatch.setattr(task, 'SUBMISSION_TIMEOUT_SEC', 0.01)
    with pytest.raises(TaskFailed, match='it did not end within 0 minutes'):
        unpack(do(pack(work)), work)


def test_a_failure_of_a_task_is_returned_with_its_traceback(work):
    with pytest.raises(TaskFailed, match='JSONDecodeError') as failed:
        unpack(do('{'), work)
    assert 'Traceback' in failed.value.trace


def result(work, **changes):
    return {'notebook': graded_lesson(work, {}), 'seconds': 1.0} | changes


def another_text(work):
    notebook = graded_lesson(work, {})
    notebook.cells[4].source += ' '
    return result(work, notebook=notebook)


def other_points(work):
    notebook = graded_lesson(work, {})
    notebook.cells[6].metadata.nbgrader.points = 99
    return result(work, notebook=notebook)


def fewer_cells(work):
    notebook = graded_lesson(work, {})
    notebook.cells.pop()
    return result(work, notebook=notebook)


@pytest.mark.parametrize(
    ('answer', 'why'),
    [
        (lambda work: [], 'did not return a result'),
        (lambda work: {}, 'did not return a result'),
        (lambda work: result(work, seconds='1'), 'did not return a result'),
        (lambda work: result(work, seconds=-1), 'did not return a result'),
        (lambda work: result(work, notebook=[]), 'did not return a result'),
        (lambda work: result(work, score=99), 'did not return a result'),
        (
            lambda work: result(work, notebook={'cells': [1], 'metadata': {}}),
            'returned a damaged notebook',
        ),
        (
            lambda work: result(work, notebook={'cells': 1, 'metadata': {}}),
            'returned a damaged notebook',
        ),
        (another_text, 'returned another notebook'),
        (other_points, 'returned another notebook'),
        (fewer_cells, 'returned another notebook'),
    ],
)
def test_a_result_that_does_not_belong_to_the_task_is_refused(work, answer, why):
    assert unpack(json.dumps(result(work)), work).seconds == 1.0
    with pytest.raises(TaskFailed, match=f'the worker {why}'):
        unpack(json.dumps(answer(work)), work)


@pytest.mark.parametrize('text', ['', '{', '[' * 100_000, 'NaN'])
def test_a_result_that_is_not_json_is_refused(work, text):
    with pytest.raises(TaskFailed, match='the worker did not return a result'):
        unpack(text, work)
