import copy
import json

import jsonschema
import nbformat
import pytest
from course_maker import executed as judged
from course_maker import toy_lesson
from nbformat.v4 import new_output

from grader.common.errors import TaskFailed
from grader.judging.result_schema import read_result
from grader.notebook.restore import KEY, make_template
from grader.sandbox.limits import (
    MAX_NOTE_CHARACTERS,
    MAX_NOTES,
    MAX_REASON_CHARACTERS,
    MAX_RESULT_BYTES,
    MAX_RESULT_PARTS,
)

WHY = 'expected 2, saw 3: add it to itself'
CHECK = 6
"""Index of the check that fails; the next cell is one that passes."""


@pytest.fixture
def asked():
    notebook = make_template(toy_lesson(), toy_lesson()).notebook
    notebook.metadata[KEY] = {'notes': ['the cell `double-check` was changed']}
    return notebook


@pytest.fixture
def answer(asked):
    """What an honest worker sends; tests spoil it."""
    notebook = judged(nbformat.from_dict(asked), {'double-check': WHY})
    notebook.metadata[KEY].seed = 'abc'
    return {'notebook': notebook, 'seconds': 1.5}


def read(answer, asked):
    text = answer if isinstance(answer, str) else json.dumps(answer)
    return read_result(text, asked, seed='abc')


def verdict(answer, cell=CHECK):
    return answer['notebook'].cells[cell].metadata[KEY]


def test_an_honest_result_is_accepted_unchanged(asked, answer):
    notebook, seconds = read(answer, asked)
    assert (notebook, seconds) == (answer['notebook'], 1.5)
    assert isinstance(notebook.cells[0].metadata, nbformat.NotebookNode)


def test_an_ungraded_result_is_accepted(asked, answer):
    answer['notebook'] = judged(answer['notebook'], {'double-check': '?'})
    assert verdict({'notebook': read(answer, asked)[0]})['outcome'] == 'ungraded'


@pytest.mark.parametrize('seconds', ['1', -1, None, True, float('nan'), float('inf'), 1e300])
def test_a_result_with_invalid_seconds_is_refused(asked, answer, seconds):
    answer['seconds'] = seconds
    with pytest.raises(TaskFailed, match='the worker did not return a result'):
        read(answer, asked)


def test_seconds_too_large_for_a_float_are_refused(asked, answer):
    text = json.dumps(answer).replace('"seconds": 1.5', '"seconds": 1e999')
    with pytest.raises(TaskFailed, match='the worker did not return a result'):
        read(text, asked)


@pytest.mark.parametrize('text', ['', '{', '[' * 100_000, 'NaN', '[]', '{}', '{"failed": "x"}'])
def test_text_that_is_not_a_result_is_refused(asked, text):
    with pytest.raises(TaskFailed, match='the worker did not return a result'):
        read(text, asked)


def test_text_larger_than_the_limit_is_refused(asked):
    with pytest.raises(TaskFailed, match='it has 100 MB; 100 MB are allowed'):
        read(' ' * (MAX_RESULT_BYTES + 1), asked)


SPOILED_VERDICTS = {
    'a number for an outcome': {'outcome': 7},
    'an unknown outcome': {'outcome': 'excellent'},
    'an outcome that no check has': {'outcome': 'manual'},
    'a list for an outcome': {'outcome': ['passed']},
    'no outcome': {'outcome': None},
    'a number for a reason': {'reason': 7},
    'a reason of megabytes': {'reason': 'x' * (MAX_REASON_CHARACTERS + 1)},
    'no reason for a zero': {'reason': ''},
    'another reason than its outputs tell': {'reason': 'somebody else failed'},
    'a reason for full points': {'outcome': 'passed'},
    'full points beside an error': {'outcome': 'passed', 'reason': ''},
    'a person asked for beside an error': {'outcome': 'ungraded'},
    'a text for notes': {'notes': 'a note'},
    'numbers for notes': {'notes': [1]},
    'a note of megabytes': {'notes': ['x' * (MAX_NOTE_CHARACTERS + 1)]},
    'notes without end': {'notes': [''] * (MAX_NOTES + 1)},
    'points of its own': {'points': 99},
    'a score of its own': {'score': -1},
    'a grade id of its own': {'grade_id': 'double-hidden'},
    'another role': {'role': 'answer'},
}


@pytest.mark.parametrize('changes', SPOILED_VERDICTS.values(), ids=SPOILED_VERDICTS)
def test_a_malformed_or_contradictory_verdict_is_refused(asked, answer, changes):
    verdict(answer).update(changes)
    with pytest.raises(TaskFailed, match='verdicts that grading cannot give: `double-check`'):
        read(answer, asked)


def result_of(text):
    return nbformat.v4.new_output('execute_result', {'text/plain': text})


@pytest.mark.parametrize('points', ['-1', '0.5', '99', 'nan', 'inf', 'x'])
@pytest.mark.parametrize('place', [CHECK, CHECK + 1])
def test_an_output_that_nbgrader_would_read_as_points_is_refused(asked, answer, place, points):
    """nbgrader takes the result of a grade cell for partial points."""
    answer['notebook'].cells[place].outputs.insert(0, result_of(points))
    with pytest.raises(TaskFailed, match='an output of a kind that no check makes'):
        read(answer, asked)


def leave_points(answer, *, earned=0.5, shown='0.5', times=1):
    cell = answer['notebook'].cells[CHECK + 1]
    cell.metadata[KEY] |= {'outcome': 'partial', 'reason': '1 wrong', 'earned': earned}
    cell.outputs = [result_of(shown) for _ in range(times)]


def test_a_partial_score_is_accepted_with_one_output_of_its_points(asked, answer):
    leave_points(answer)
    assert read(answer, asked)


@pytest.mark.parametrize(
    'spoiled',
    [
        {'earned': 0.0, 'shown': '0.0'},
        {'earned': 2.0, 'shown': '2.0'},
        {'earned': 99.0, 'shown': '2.0'},
        {'earned': '1'},
        {'shown': '1.0'},
        {'shown': 'x'},
        {'times': 0},
        {'times': 2},
    ],
)
def test_invalid_or_differing_partial_points_are_refused(asked, answer, spoiled):
    leave_points(answer, **spoiled)
    with pytest.raises(TaskFailed, match='verdicts that grading cannot give: `double-hidden`'):
        read(answer, asked)


def test_a_failed_check_with_two_error_outputs_is_refused(asked, answer):
    cell = answer['notebook'].cells[CHECK]
    cell.outputs.append(cell.outputs[-1])
    with pytest.raises(
        TaskFailed, match='its error output differs from the reason in its verdict'
    ):
        read(answer, asked)


def test_a_check_with_output_on_stderr_is_refused(asked, answer):
    answer['notebook'].cells[CHECK + 1].outputs[0].name = 'stderr'
    with pytest.raises(TaskFailed, match='an output of a kind that no check makes'):
        read(answer, asked)


def another_text(notebook):
    notebook.cells[4].source += ' '


def another_check(notebook):
    notebook.cells[CHECK].source = 'pass'


def more_points(notebook):
    notebook.cells[CHECK].metadata.nbgrader.points = 99


def negative_points(notebook):
    notebook.cells[CHECK].metadata.nbgrader.points = -1


def no_number_of_points(notebook):
    notebook.cells[CHECK].metadata.nbgrader.points = '1'


def an_unknown_grade_id(notebook):
    notebook.cells[CHECK].metadata.nbgrader.grade_id = 'another'


def one_more_check(notebook):
    notebook.cells.append(copy.deepcopy(notebook.cells[CHECK]))


def one_less(notebook):
    notebook.cells.pop()


def another_kernel(notebook):
    notebook.metadata['kernelspec'] = {'name': 'mine', 'display_name': '<b>'}


def a_picture_that_nobody_pasted(notebook):
    notebook.cells[0]['attachments'] = {'x.png': {'image/png': 'aGk='}}


def another_key_beside_the_verdict(notebook):
    notebook.cells[CHECK].metadata['more'] = 1


def another_key_in_an_output(notebook):
    """It would pass `nbformat.validate(…, relax_add_props=True)`, and no reading or writing."""
    notebook.cells[1].outputs = [{'output_type': 'stream', 'name': 'stdout', 'text': '', 'a': 1}]


def an_output_of_no_kind(notebook):
    notebook.cells[1].outputs = [{'output_type': 'x'}]


def a_later_format(notebook):
    notebook.nbformat_minor = 6


SPOILED_NOTEBOOKS = [
    another_text, another_check, more_points, negative_points, no_number_of_points,
    an_unknown_grade_id, one_more_check, one_less, another_kernel, a_picture_that_nobody_pasted,
    another_key_beside_the_verdict, another_key_in_an_output, an_output_of_no_kind, a_later_format,
]  # fmt: skip


@pytest.mark.parametrize('spoil', [another_key_in_an_output, an_output_of_no_kind])
def test_a_damaged_notebook_is_refused_without_collecting_its_schema_errors(
    asked, answer, spoil, monkeypatch
):
    """jsonschema would take 40 s and 1.4 GB for 30,000 outputs."""
    spoil(answer['notebook'])
    text = json.dumps(answer)
    asked_again = []
    monkeypatch.setattr(jsonschema.Draft4Validator, 'iter_errors', lambda *_: asked_again)
    with pytest.raises(TaskFailed, match='returned a damaged notebook'):
        read(text, asked)


@pytest.mark.parametrize('part', ['{}', '[]', '{"a": 1}', '["{", {}]'])
def test_text_with_too_many_objects_and_lists_is_refused_unparsed(asked, monkeypatch, part):
    monkeypatch.setattr(json, 'loads', lambda *_, **__: pytest.fail('it was read'))
    cells = ','.join([part] * (MAX_RESULT_PARTS + 1))
    with pytest.raises(TaskFailed, match='objects and lists; 200,000 are allowed'):
        read('{"seconds": 1, "notebook": {"cells": [' + cells + ']}}', asked)


@pytest.mark.parametrize('text', ['{[' * 150_000, '\\"{' * 150_000, '{\\' * 210_000])
def test_brackets_in_printed_text_do_not_count_as_objects_or_lists(asked, answer, text):
    answer['notebook'].cells[1].outputs = [new_output('stream', name='stdout', text=text)]
    assert read(answer, asked)[0].cells[1].outputs[0].text == text


@pytest.mark.parametrize('text', ['"' + '\\"{' * 300_000, '"' + '\\"' * 300_000 + '\\'])
def test_a_string_that_never_ends_is_refused(asked, text):
    with pytest.raises(
        TaskFailed, match='the worker did not return a result of grading: Unterminated string'
    ):
        read(text, asked)


@pytest.mark.parametrize('spoil', SPOILED_NOTEBOOKS)
def test_a_result_that_changes_more_than_verdicts_and_outputs_is_refused(asked, answer, spoil):
    spoil(answer['notebook'])
    why = 'the worker returned (another|a damaged) notebook'
    with pytest.raises(TaskFailed, match=why):
        read(answer, asked)


@pytest.mark.parametrize(
    ('place', 'changes'),
    [
        (None, {'seed': 'another'}),
        (None, {'in_sandbox': 'so it was'}),
        (None, {'notes': []}),
        (None, {'problem': 'not submitted'}),
        (4, {'outcome': 'passed'}),
        (4, {'role': 'grade'}),
        (0, {'role': 'answer'}),
    ],
)
def test_a_result_that_changes_the_restored_metadata_is_refused(asked, answer, place, changes):
    notebook = answer['notebook']
    (notebook if place is None else notebook.cells[place]).metadata[KEY].update(changes)
    with pytest.raises(TaskFailed, match='verdicts that grading cannot give'):
        read(answer, asked)


def test_a_check_without_a_verdict_is_refused(asked, answer):
    del answer['notebook'].cells[CHECK].metadata[KEY]
    with pytest.raises(TaskFailed, match='verdicts that grading cannot give'):
        read(answer, asked)


def test_a_failed_worker_may_report_a_reason_of_limited_length(asked):
    with pytest.raises(TaskFailed, match='no room') as failed:
        read({'failed': 'no room', 'traceback': 'in rooms.py'}, asked)
    assert failed.value.trace == 'in rooms.py'
    with pytest.raises(TaskFailed, match='the worker did not return a result'):
        read({'failed': 'x' * (MAX_REASON_CHARACTERS + 1), 'traceback': ''}, asked)
