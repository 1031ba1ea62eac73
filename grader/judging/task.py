"""Grade one submission: a function of text, which may run anywhere, and again after a crash."""

import asyncio
import base64
import json
import tempfile
import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat
from nbformat import NotebookNode

from grader.common.errors import CourseError
from grader.judging.result_schema import read_result
from grader.sandbox.limits import MAX_REASON_CHARACTERS, SUBMISSION_TIMEOUT_SEC
from grader.sandbox.temporary_folders import own_folder

if TYPE_CHECKING:
    from grader.judging.execute import Execution


@dataclass(frozen=True)
class GradingTask:
    """All that the grading of one submission depends on."""

    notebook: NotebookNode
    """Restored and prepared: the lesson's cells with the student's answers."""
    seed: str
    """Decides the inputs that hidden tests choose."""
    files: Mapping[str, bytes] = field(default_factory=dict)
    """The student's own Python files, by name, and the files of packages, by path."""
    trust_students: bool = False


@dataclass(frozen=True)
class Result:
    """The result of a task."""

    notebook: NotebookNode
    """With a verdict in each grade cell."""
    seconds: float
    """Seconds from the first kernel's start to the last kernel's end."""


def pack(task: GradingTask) -> str:
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


async def run_packed(text: str) -> str:
    """Do a packed task; return its result, or its error, as ASCII JSON. Raises nothing."""
    try:
        return json.dumps(await _graded(json.loads(text)))
    except Exception as error:  # reported to the process that sent the task
        said = f'{type(error).__name__}: {error}'[:MAX_REASON_CHARACTERS]
        trace = traceback.format_exc()[-MAX_REASON_CHARACTERS:]
        return json.dumps({'failed': said, 'traceback': trace})


def unpack(text: str, task: GradingTask) -> Result:
    """Check the packed result of a task, and return it.

    Raises TaskFailed if the task failed, or if the text is not a result of it.
    """
    return Result(*read_result(text, task.notebook, seed=task.seed))


def _inside(name: str) -> str:
    """Return `name` if it leads to a file inside a folder. Raises ValueError if it does not."""
    if Path(name).is_absolute() or not {*Path(name).parts}.isdisjoint({'..', '.'}):
        raise ValueError(f'{name!r} is not the path of a file in a submission')
    return name


async def execute_exercises(notebook: NotebookNode, **options: Any) -> 'Execution':
    """Run and judge a notebook's exercises."""
    # imported late: a process that only hands out tasks needs none of the modules for kernels
    from grader.judging import execute

    return await execute.execute_exercises(notebook, **options)


async def _graded(task: dict) -> dict:
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix='files-', dir=own_folder()) as folder:
        for name, text in task['files'].items():
            path = Path(folder, _inside(name))
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(base64.b64decode(text))
        paths = sorted(Path(folder).iterdir())
        try:
            async with asyncio.timeout(SUBMISSION_TIMEOUT_SEC):
                execution = await execute_exercises(
                    nbformat.from_dict(task['notebook']),
                    extra_files=paths,
                    seed=task['seed'],
                    trust_students=task['trust_students'],
                )
        except TimeoutError:
            limit = f'{SUBMISSION_TIMEOUT_SEC / 60:.0f} minutes'
            raise CourseError(f'it did not end within {limit}') from None
    return {'notebook': execution.notebook, 'seconds': time.monotonic() - start}
