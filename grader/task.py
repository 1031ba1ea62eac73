"""Grade one submission: a pure function of text, which may run anywhere, twice, after a crash."""

import asyncio
import base64
import json
import tempfile
import time
import traceback
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import jsonschema
import nbformat
from nbformat import NotebookNode

from grader.errors import CourseError, TaskFailed
from grader.execute import executed
from grader.heal import KEY
from grader.leftovers import own_folder
from grader.limits import SUBMISSION_TIMEOUT_SEC


@dataclass(frozen=True)
class Task:
    """All that the grading of one submission depends on."""

    notebook: NotebookNode
    """Healed and prepared: the lesson's cells with the student's answers."""
    seed: str
    """Decides the inputs that hidden tests choose."""
    files: Mapping[str, bytes] = field(default_factory=dict)
    """The student's own Python files, by name."""
    trust_students: bool = False


@dataclass(frozen=True)
class Result:
    """What came of a task."""

    notebook: NotebookNode
    """With a verdict in each grade cell."""
    seconds: float
    """How long that took, from the first kernel's start to the last one's end."""


_RESULT = jsonschema.Draft202012Validator(
    {
        'oneOf': [
            {
                'properties': {
                    'notebook': {'type': 'object', 'required': ['cells', 'metadata']},
                    'seconds': {'type': 'number', 'minimum': 0},
                },
                'required': ['notebook', 'seconds'],
                'additionalProperties': False,
            },
            {
                'properties': {
                    'failed': {'type': 'string'},
                    'traceback': {'type': 'string'},
                },
                'required': ['failed', 'traceback'],
                'additionalProperties': False,
            },
        ],
        'type': 'object',
    }
)


def packed(task: Task) -> str:
    """Return a task as JSON, in ASCII."""
    files = {name: base64.b64encode(raw).decode('ascii') for name, raw in task.files.items()}
    return json.dumps(
        {
            'notebook': task.notebook,
            'seed': task.seed,
            'files': files,
            'trust_students': task.trust_students,
        }
    )


async def graded(text: str) -> str:
    """Do a packed task; return what came of it as JSON, in ASCII. Nothing is raised."""
    try:
        return json.dumps(await _graded(json.loads(text)))
    except Exception as error:  # told to whoever has sent it
        said = f'{type(error).__name__}: {error}'
        return json.dumps({'failed': said, 'traceback': traceback.format_exc()})


def unpacked(text: str, task: Task) -> Result:
    """Check what came of a task, and return it. Raises TaskFailed where it failed."""
    try:
        found = json.loads(text)
        _RESULT.validate(found)
    except (ValueError, RecursionError, jsonschema.ValidationError) as error:
        why = str(error).partition('\n')[0]
        raise TaskFailed(f'what came back is not a result: {why}') from None
    if 'failed' in found:
        raise TaskFailed(found['failed'], found['traceback'])
    notebook = nbformat.from_dict(found['notebook'])
    try:
        nbformat.validate(notebook, relax_add_props=True)
        same = _text(notebook.cells) == _text(task.notebook.cells)
    except (nbformat.ValidationError, AttributeError) as error:
        why = str(error).partition('\n')[0]
        raise TaskFailed(f'what came back is not a notebook: {why}') from None
    if not same:
        raise TaskFailed('what came back is another notebook')
    return Result(notebook, found['seconds'])


async def _graded(task: dict) -> dict:
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix='files-', dir=own_folder()) as folder:
        paths = []
        for name, text in task['files'].items():
            paths.append(Path(folder, Path(name).name))
            paths[-1].write_bytes(base64.b64decode(text))
        try:
            async with asyncio.timeout(SUBMISSION_TIMEOUT_SEC):
                execution = await executed(
                    nbformat.from_dict(task['notebook']),
                    extra_files=paths,
                    seed=task['seed'],
                    trust_students=task['trust_students'],
                )
        except TimeoutError:
            limit = f'{SUBMISSION_TIMEOUT_SEC / 60:.0f} minutes'
            raise CourseError(f'it had not come to its end after {limit}') from None
    return {'notebook': execution.notebook, 'seconds': time.monotonic() - start}


def _text(cells: Iterable[NotebookNode]) -> list:
    """Return what a run leaves as it is."""
    marks = [{k: v for k, v in cell.metadata.items() if k != KEY} for cell in cells]
    return [(c.cell_type, c.source, c.get('id'), m) for c, m in zip(cells, marks, strict=True)]
