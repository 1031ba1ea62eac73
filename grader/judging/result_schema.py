"""Check the result that a worker sends: nothing else of it reaches the gradebook.

A worker runs student code, perhaps on another machine. What it sends is text, and is accepted
only if it has the form of a result that grading can have.
"""

import json
import re
from collections.abc import Iterator
from typing import Any

import jsonschema
import nbformat
from my_robot_basics.validate.lessons.cells import KEY, grade_id, role
from nbformat import NotebookNode
from nbformat.validator import get_validator

from grader.common.errors import TaskFailed
from grader.sandbox.limits import (
    MAX_NOTE_CHARACTERS,
    MAX_NOTES,
    MAX_REASON_CHARACTERS,
    MAX_RESULT_BYTES,
    MAX_RESULT_PARTS,
)

_MOST_SECONDS = 1e6
"""Eleven days, longer than any worker runs."""
_NO_RESULT = 'the worker did not return a result of grading'
_STRING = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*(?:"|\\?\Z)', re.DOTALL)  # may lack its end
_MADE_BY_A_RUN = ('outputs', 'execution_count', 'metadata')
"""What a run may change in a cell; in `metadata`, only the value of KEY."""

_NOTES = {
    'type': 'array',
    'maxItems': MAX_NOTES,
    'items': {'type': 'string', 'maxLength': MAX_NOTE_CHARACTERS},
}
_RESULT = jsonschema.Draft202012Validator(
    {
        'oneOf': [
            {
                'properties': {
                    'notebook': {'type': 'object', 'required': ['cells', 'metadata']},
                    'seconds': {'type': 'number', 'minimum': 0, 'maximum': _MOST_SECONDS},
                },
                'required': ['notebook', 'seconds'],
                'additionalProperties': False,
            },
            {
                'properties': {
                    'failed': {'type': 'string', 'maxLength': MAX_REASON_CHARACTERS},
                    'traceback': {'type': 'string', 'maxLength': 10 * MAX_REASON_CHARACTERS},
                },
                'required': ['failed', 'traceback'],
                'additionalProperties': False,
            },
        ],
        'type': 'object',
    }
)
_VERDICT = jsonschema.Draft202012Validator(
    {
        'type': 'object',
        'properties': {
            'role': {'const': 'grade'},
            'outcome': {'enum': ['passed', 'partial', 'failed', 'ungraded']},
            'reason': {'type': 'string', 'maxLength': MAX_REASON_CHARACTERS},
            'notes': _NOTES,
            'details': {'type': 'string', 'maxLength': MAX_REASON_CHARACTERS},
            'earned': {'type': 'number', 'minimum': 0},
            'failed_at_grading': {'type': 'boolean'},
            'hint': {'type': 'string', 'maxLength': MAX_REASON_CHARACTERS},
        },
        'required': ['role', 'outcome', 'reason', 'notes'],
        'additionalProperties': False,
        # a verdict other than 'passed' needs a reason
        'if': {'properties': {'outcome': {'const': 'passed'}}},
        'then': {'properties': {'reason': {'const': ''}}},
        'else': {'properties': {'reason': {'minLength': 1}}},
    }
)


def read_result(text: str, asked: NotebookNode, *, seed: str) -> tuple[NotebookNode, float]:
    """Return the graded notebook and the seconds of grading from a worker's answer.

    `asked` is the notebook that was to be graded, with the inputs of `seed`. Raises TaskFailed
    if the worker says that it failed, or if the answer is not a possible result of grading.
    """
    if len(text) > MAX_RESULT_BYTES:
        allowed = f'{MAX_RESULT_BYTES / 1e6:.0f} MB are allowed'
        raise TaskFailed(f'{_NO_RESULT}: it has {len(text) / 1e6:.0f} MB; {allowed}')
    try:
        _refuse_many_parts(text)
        found = json.loads(text, parse_constant=_refuse_constant)
        _RESULT.validate(found)
    except (ValueError, RecursionError, jsonschema.ValidationError) as error:
        raise TaskFailed(f'{_NO_RESULT}: {_first_line(error)}') from None
    if 'failed' in found:
        raise TaskFailed(found['failed'], found['traceback'])
    try:
        notebook = nbformat.from_dict(found['notebook'])
        _expect_valid(notebook, asked)
        same = _fixed_parts(notebook) == _fixed_parts(asked)
    except (nbformat.ValidationError, AttributeError, RecursionError) as error:
        raise TaskFailed(f'the worker returned a damaged notebook: {_first_line(error)}') from None
    if not same:
        raise TaskFailed('the worker returned another notebook than the one it was given to grade')
    if problem := next(_problems(notebook, asked, seed), ''):
        raise TaskFailed(f'the worker returned verdicts that grading cannot give: {problem}')
    return notebook, float(found['seconds'])


def _problems(notebook: NotebookNode, asked: NotebookNode, seed: str) -> Iterator[str]:
    """Yield what is wrong with what a run has written into a notebook."""
    ours, given = (dict(each.metadata.get(KEY, {})) for each in (notebook, asked))
    if not isinstance(ours.pop('in_sandbox', True), bool):
        yield '`in_sandbox` is neither true nor false'
    if ours != {'notes': []} | given | {'seed': seed}:
        yield 'its notes on restored cells, or its seed, are not those that the worker was given'
    for cell, before in zip(notebook.cells, asked.cells, strict=True):
        if cell.cell_type == 'code' and role(before) == 'grade':
            yield from _problems_of_check(cell)
        elif cell.metadata.get(KEY) != before.metadata.get(KEY):
            yield f'`{grade_id(cell) or cell.get("id")}` has a verdict, but is not a check'


def _problems_of_check(cell: NotebookNode) -> Iterator[str]:
    """Yield what is wrong with the verdict in a grade cell, and with the score read from it."""
    # imported late: it imports nbgrader's servers, too, which doubles a worker's start-up time
    from nbgrader.utils import determine_grade

    name, verdict = grade_id(cell), cell.metadata.get(KEY)
    for error in _VERDICT.iter_errors(verdict):
        yield f'`{name}`: {error.json_path}: {_first_line(error)}'
        return
    errors = [output for output in cell.outputs if output.output_type == 'error']
    is_partial = verdict['outcome'] == 'partial'
    points_kind = ['execute_result'] if is_partial else []
    results = [output for output in cell.outputs if output.output_type in points_kind]
    others = [out for out in cell.outputs if out.output_type not in ('error', *points_kind)]
    if not all(_is_text_or_picture(output) for output in others):
        yield f'`{name}`: it has an output of a kind that no check makes'
        return
    wanted = [verdict['reason']] if verdict['outcome'] == 'failed' else []
    if [error.evalue for error in errors] != wanted:
        yield f'`{name}`: its error output differs from the reason in its verdict'
        return
    points, earned = cell.metadata.nbgrader.points, verdict.get('earned', 0.0)
    if is_partial != (0.0 < earned < points) or len(results) != is_partial:
        yield f'`{name}`: {earned:g} of {points:g} points for {verdict["outcome"]!r}'
        return
    score = {'passed': points, 'partial': earned, 'failed': 0.0}.get(verdict['outcome'])
    if score is not None and determine_grade(cell) != (score, points):
        yield f'`{name}`: nbgrader would compute another score from its outputs'


def _is_text_or_picture(output: NotebookNode) -> bool:
    """Whether an output is text or a picture: nbgrader reads a cell's result as points."""
    if output.output_type == 'stream':
        return output.name == 'stdout'
    return output.output_type == 'display_data'


def _fixed_parts(notebook: NotebookNode) -> list[Any]:
    """Return the parts of a notebook that a run does not change."""
    found: list[Any] = [{k: v for k, v in notebook.metadata.items() if k != KEY}]
    found += [notebook.nbformat, notebook.nbformat_minor]
    for cell in notebook.cells:
        marks = {k: v for k, v in cell.metadata.items() if k != KEY}
        found.append(({k: v for k, v in cell.items() if k not in _MADE_BY_A_RUN}, marks))
    return found


def _refuse_many_parts(text: str) -> None:
    """Raise ValueError for JSON that would take many times the memory of its text."""
    parts = sum(map(_STRING.sub('', text).count, '{['))
    if parts > MAX_RESULT_PARTS:
        raise ValueError(f'it has {parts:,} objects and lists; {MAX_RESULT_PARTS:,} are allowed')


def _expect_valid(notebook: NotebookNode, asked: NotebookNode) -> None:
    """Raise ValidationError if a notebook breaks a rule of its format.

    nbformat's own check then composes a message: 40 s and 1.4 GB for 30,000 outputs.
    """
    if (notebook.nbformat, notebook.nbformat_minor) != (asked.nbformat, asked.nbformat_minor):
        raise nbformat.ValidationError('its nbformat version is not that of the lesson')
    get_validator(asked.nbformat, asked.nbformat_minor, name='fastjsonschema').validate(notebook)


def _refuse_constant(name: str) -> float:
    raise ValueError(f'it contains {name}, which JSON does not allow')


def _first_line(error: Exception) -> str:
    said = getattr(error, 'message', '') or str(error)
    return said.partition('\n')[0][:300]
