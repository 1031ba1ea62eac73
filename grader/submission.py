"""Read what a student handed in; refuse what cannot be read, by name and reason."""

import json
import re
import secrets
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import nbformat
from my_robot_basics.validate.pictures import KINDS, why_not_shown
from nbformat import NotebookNode

from grader.dates import date_of
from grader.errors import UnreadableSubmission
from grader.parsing import TooHard, parse

MAX_NOTEBOOK_BYTES = 20_000_000
"""More than any lesson with all its pictures; a larger file is refused, not read."""

MAX_BYTES_HERE = 1_000_000
"""A larger file is read in a process of its own."""
MAX_PYTHON_FILES, MAX_PYTHON_BYTES = 50, 2_000_000
"""Of the student's own modules together: twenty times what the whole course has."""
_MOST_NOTES = 10
MAX_CELLS = 2_000
MAX_CHARACTERS = 500_000
"""Of all cells together, pictures apart: twenty times what a lesson has."""
TIMESTAMP = 'timestamp.txt'
"""Beside a notebook: when it was handed in, as nbgrader writes it."""


@dataclass(frozen=True)
class Submission:
    """One notebook of one student, as it was handed in."""

    student_id: str
    assignment: str
    path: Path
    """Where the notebook is, or was expected."""
    notebook: NotebookNode | None
    """Cell types, sources and grade ids only; None when it could not be read."""
    extra_files: tuple[Path, ...] = ()
    """The student's own Python files beside the notebook."""
    problem: str | None = None
    """Why the notebook could not be read."""
    notes: tuple[str, ...] = ()
    """What of it is not taken, and why."""


def read_submission(folder: Path, *, student_id: str, assignment: str) -> Submission:
    """Read `folder`/`assignment`.ipynb; what is wrong with it ends up in `problem`."""
    path = folder / f'{assignment}.ipynb'
    taken, notes = _python_files(folder)
    try:
        notebook, problem = read_notebook(path), None
    except UnreadableSubmission as error:
        notebook, problem = None, str(error)
    return Submission(
        student_id=student_id,
        assignment=assignment,
        path=path,
        notebook=notebook,
        extra_files=tuple(taken),
        problem=problem,
        notes=tuple(notes),
    )


def extra_python_files(folder: Path) -> list[Path]:
    """Return the plain .py files that lie directly in `folder`, sorted; links don't count.

    Of many, or large ones, those come that fit within MAX_PYTHON_FILES and MAX_PYTHON_BYTES.
    """
    return _python_files(folder)[0]


def _python_files(folder: Path) -> tuple[list[Path], list[str]]:
    """Return the files that are taken, and a note for each other one."""
    taken, notes, left = [], [], MAX_PYTHON_BYTES
    for path in sorted(p for p in folder.glob('*.py') if p.is_file() and not p.is_symlink()):
        size = path.stat().st_size
        if size <= left and len(taken) < MAX_PYTHON_FILES:
            taken.append(path)
            left -= size
        elif len(notes) < _MOST_NOTES:
            notes.append(
                f'the file `{path.name}` of {size / 1e6:.1f} MB was left out: at most '
                f'{MAX_PYTHON_FILES} Python files of {MAX_PYTHON_BYTES / 1e6:.0f} MB together '
                'are taken'
            )
    return taken, notes


def timestamps(submission: Submission) -> list[Path]:
    """Return nbgrader's timestamp.txt, if it lies beside the notebook."""
    path = submission.path.with_name(TIMESTAMP)
    return [path] if path.is_file() and not path.is_symlink() else []


def handed_in(submission: Submission) -> tuple[datetime | None, list[str]]:
    """Read when it was handed in (UTC, without a zone) and what is wrong with that file."""
    if not (found := timestamps(submission)):
        return None, []
    if when := date_of(found[0]):
        return when.replace(tzinfo=None), []
    return None, [f'{TIMESTAMP} holds no date: counted as handed in on time']


def read_notebook(path: Path) -> NotebookNode:
    """Read a notebook that nobody vouches for, keeping only what grading needs.

    A large one is read in a process with limits: JSON may take 30 times its size in memory. Raises
    UnreadableSubmission with a sentence for the student.
    """
    if path.is_symlink() or not path.is_file() or path.stat().st_size <= MAX_BYTES_HERE:
        return _read(path)
    try:
        said = parse('grader.submission:read_apart', str(path))
    except TooHard as why:
        raise UnreadableSubmission(
            f'{path.name} is not read, for {why}: choose "Clear All Outputs" in JupyterLab, save, '
            'and submit again.'
        ) from None
    if problem := said.get('problem'):
        raise UnreadableSubmission(problem)
    return nbformat.from_dict(said['notebook'])


def read_apart(path: str) -> dict:
    """Read a notebook; return it, or what is wrong with it, as JSON."""
    try:
        return {'notebook': _read(Path(path))}
    except UnreadableSubmission as error:
        return {'problem': str(error)}


def _read(path: Path) -> NotebookNode:
    raw = _read_json(path)
    if not isinstance(raw, dict) or not isinstance(raw.get('nbformat'), int):
        raise UnreadableSubmission(
            f'{path.name} is JSON but not a notebook: save the lesson in JupyterLab and submit '
            'that file.'
        )
    cells = raw.get('cells')
    if raw['nbformat'] < 4:
        cells = [c for sheet in _dicts(raw.get('worksheets')) for c in _dicts(sheet.get('cells'))]
    cells = _dicts(cells)
    if not cells:
        raise UnreadableSubmission(f'{path.name} has no cells: submit the notebook you worked in.')
    if len(cells) > MAX_CELLS:
        raise UnreadableSubmission(
            f'{path.name} has {len(cells)} cells, more than the {MAX_CELLS} that are graded.'
        )
    cells = [_clean_cell(cell) for cell in cells]
    characters = sum(len(cell.source) for cell in cells)
    if characters > MAX_CHARACTERS:
        raise UnreadableSubmission(
            f'{path.name} has {characters:,} characters of text and code, more than the '
            f'{MAX_CHARACTERS:,} that are graded.'
        )
    return nbformat.v4.new_notebook(cells=cells)


def _read_json(path: Path) -> object:
    if path.is_symlink() or not path.is_file():
        found = sorted(p.name for p in path.parent.glob('*') if p.is_file())[:5]
        listing = ', '.join(found) or 'nothing'
        raise UnreadableSubmission(
            f'there is no file {path.name}; found {listing}. Submit the notebook under its '
            'own name.'
        )
    size = path.stat().st_size
    if size > MAX_NOTEBOOK_BYTES:
        raise UnreadableSubmission(
            f'{path.name} has {size / 1e6:.0f} MB, more than {MAX_NOTEBOOK_BYTES / 1e6:.0f} MB: '
            'choose "Clear All Outputs" in JupyterLab, save, and submit again.'
        )
    try:
        raw = path.read_bytes()
        return json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise UnreadableSubmission(
            f'{path.name} is not JSON ({_one_line(error)}): the file is damaged or not a '
            'notebook. Save it again in JupyterLab and submit that file.'
        ) from None
    except OSError as error:
        raise UnreadableSubmission(f'{path.name} could not be read: {error.strerror}.') from None


def _clean_cell(cell: dict) -> NotebookNode:
    """Keep type, source, id, grade id and pasted pictures; drop outputs and all other metadata."""
    source = _text(cell.get('source', cell.get('input', '')))
    cell_id = cell.get('id')
    metadata = {}
    nbgrader = cell.get('metadata')
    nbgrader = nbgrader.get('nbgrader') if isinstance(nbgrader, dict) else None
    grade_id = nbgrader.get('grade_id') if isinstance(nbgrader, dict) else None
    if isinstance(grade_id, str):
        metadata = {'nbgrader': {'grade_id': grade_id}}
    kind = cell.get('cell_type')
    # nbformat's own functions for this check each cell against all of their schema
    clean = {
        'id': secrets.token_hex(4),
        'cell_type': kind if kind in ('code', 'raw') else 'markdown',
        'metadata': metadata,
        'source': source,
    }
    if isinstance(cell_id, str) and re.fullmatch('[a-zA-Z0-9_-]{1,64}', cell_id):
        clean['id'] = cell_id
    if kind == 'code':
        clean |= {'execution_count': None, 'outputs': []}
    elif clean['cell_type'] == 'markdown' and (pictures := _pictures(cell.get('attachments'))):
        clean['attachments'] = pictures
    return nbformat.from_dict(clean)


def _pictures(attachments: object) -> NotebookNode:
    """Return the pasted PNG and JPEG pictures of a markdown cell: {name: {type: base64}}."""
    kept = {}
    if isinstance(attachments, dict):
        for name, bundle in attachments.items():
            if isinstance(bundle, dict):
                pictures = {
                    mime: data
                    for mime, data in bundle.items()
                    if mime in KINDS and isinstance(data, str) and not why_not_shown(data)
                }
                if pictures:
                    kept[name] = pictures
    return nbformat.from_dict(kept)


def _dicts(value: object) -> Iterable[dict]:
    return [v for v in value if isinstance(v, dict)] if isinstance(value, list) else []


def _text(value: object) -> str:
    if isinstance(value, list):
        value = ''.join(part for part in value if isinstance(part, str))
    # a lone surrogate can't be written to any file or socket
    return value.encode(errors='replace').decode() if isinstance(value, str) else ''


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split())[:120] or type(error).__name__
