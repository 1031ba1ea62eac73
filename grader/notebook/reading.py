"""Read a notebook of unknown origin in a process with limits; check the result."""

from pathlib import Path

import jsonschema
import nbformat
from my_robot_basics.language.speaking import KEY, LANGUAGE
from my_robot_basics.validate.kernels.pictures import KINDS
from nbformat import NotebookNode

from grader.common.errors import CourseError, UnreadableSubmission
from grader.common.parsing import ParsingFailed, parse
from grader.notebook import raw_notebook
from grader.notebook.raw_notebook import (
    LANGUAGES,
    MAX_CELLS,
    MAX_CHARACTERS,
    MAX_GRADE_ID_CHARACTERS,
    MAX_PICTURES,
)

_EMPTY = {'nbformat': 4, 'nbformat_minor': 5, 'metadata': {}, 'cells': []}
"""An empty notebook; with nbformat's functions, each cell would be checked against all of it."""

_CELL = {
    'type': 'object',
    'properties': {
        'id': {'type': 'string', 'pattern': '^[a-zA-Z0-9_-]{1,64}\\Z'},
        'cell_type': {'enum': ['code', 'markdown', 'raw']},
        'metadata': {
            'type': 'object',
            'properties': {
                'nbgrader': {
                    'type': 'object',
                    'properties': {
                        'grade_id': {'type': 'string', 'maxLength': MAX_GRADE_ID_CHARACTERS}
                    },
                    'additionalProperties': False,
                }
            },
            'additionalProperties': False,
        },
        'source': {'type': 'string', 'maxLength': MAX_CHARACTERS},
        'attachments': {
            'type': 'object',
            'maxProperties': MAX_PICTURES,
            'additionalProperties': {
                'type': 'object',
                'properties': {kind: {'type': 'string'} for kind in KINDS},
                'additionalProperties': False,
            },
        },
        'outputs': {'const': []},
        'execution_count': {'const': None},
    },
    'required': ['id', 'cell_type', 'metadata', 'source'],
    'additionalProperties': False,
}
_READ = jsonschema.Draft202012Validator(
    {
        'type': 'object',
        'properties': {
            'cells': {'type': 'array', 'minItems': 1, 'maxItems': MAX_CELLS, 'items': _CELL},
            'problem': {'type': 'string', 'minLength': 1, 'maxLength': 2_000},
            LANGUAGE: {'type': 'string', 'pattern': f'^{LANGUAGES}\\Z'},
        },
        'oneOf': [{'required': ['cells']}, {'required': ['problem']}],
        'dependentRequired': {LANGUAGE: ['cells']},
        'additionalProperties': False,
    }
)
"""What the process that reads a notebook may return."""


def read_notebook(path: Path) -> NotebookNode:
    """Read a notebook of unknown origin, keeping only what grading needs.

    It is read in a process with limits, and the result is checked. Raises UnreadableSubmission
    with a sentence for the student.
    """
    try:
        said = parse(f'{raw_notebook.__name__}:read', str(path))
    except ParsingFailed as why:
        raise UnreadableSubmission(
            f'{path.name} was not read, because {why}: choose "Clear Outputs of All Cells" in '
            'JupyterLab, save, and submit again.'
        ) from None
    for error in _READ.iter_errors(said):
        raise CourseError(
            f'the program that reads {path.name} returned no notebook: {error.json_path}'
        )
    if problem := said.get('problem'):
        raise UnreadableSubmission(problem)
    metadata = {KEY: {LANGUAGE: said[LANGUAGE]}} if LANGUAGE in said else {}
    return nbformat.from_dict(_EMPTY | {'cells': said['cells'], 'metadata': metadata})
