"""Read a submitted notebook, keeping the cells that grading needs; runs with limits.

`reading` calls it in a separate process, and checks the result. It uses plain JSON, not nbformat.
"""

import json
import re
import secrets
from pathlib import Path

from my_robot_basics.language.speaking import KEY, LANGUAGE
from my_robot_basics.validate.kernels.pictures import KINDS, why_not_shown

from grader.common.errors import UnreadableSubmission

MAX_NOTEBOOK_BYTES = 20_000_000
"""More than any lesson with all its pictures; a larger file is refused unread."""
LANGUAGES = '[A-Za-z_]{2,20}'
"""A pattern for names of languages, such as zh_CN."""
MAX_CELLS = 800
MAX_CHARACTERS = 500_000
"""For all cells together, without pictures. Both limits are twenty times what a lesson has: the
notebook is restored, checked and written several times in the process of the gradebook."""
MAX_GRADE_ID_CHARACTERS = 128
"""A longer one is not from a lesson, and is dropped."""
MAX_PICTURES, MAX_PICTURE_NAME_CHARACTERS = 200, 255
"""Pasted pictures of all cells: each is checked whenever the notebook is written."""
_CONFLICT = re.compile(rb'^<{7} ', re.MULTILINE)
"""What Git writes above the first of two versions that it can't merge."""
_SPACE = b'\xef\xbb\xbf \t\r\n'
"""White space, and the mark that may precede it at the beginning of UTF-8."""


def read(path: str) -> dict:
    """Read a notebook; return its cells and language, or its problem, as JSON."""
    try:
        raw = _read_json(Path(path))
        return {'cells': _cells(Path(path), raw)} | _language(raw)
    except UnreadableSubmission as error:
        return {'problem': str(error)}


def _language(raw: object) -> dict[str, str]:
    """Return the language that the notebook's metadata names: its feedback is in this language."""
    said = raw
    for name in ('metadata', KEY, LANGUAGE):
        said = said.get(name) if isinstance(said, dict) else None
    is_one = isinstance(said, str) and re.fullmatch(LANGUAGES, said)
    return {LANGUAGE: said} if isinstance(said, str) and is_one else {}


def _cells(path: Path, raw: object) -> list[dict]:
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
    characters = sum(len(cell['source']) for cell in cells)
    if characters > MAX_CHARACTERS:
        raise UnreadableSubmission(
            f'{path.name} has {characters:,} characters of text and code, more than the '
            f'{MAX_CHARACTERS:,} that are graded.'
        )
    pictures = sum(len(cell.get('attachments', ())) for cell in cells)
    if pictures > MAX_PICTURES:
        raise UnreadableSubmission(
            f'{path.name} has {pictures:,} pasted pictures, more than the {MAX_PICTURES} that are '
            'graded.'
        )
    return cells


def _read_json(path: Path) -> object:
    if path.is_symlink() or not path.is_file():
        found = sorted(_text(p.name) for p in path.parent.glob('*') if p.is_file())[:5]
        listing = ', '.join(found) or 'nothing'
        raise UnreadableSubmission(
            f'there is no file {path.name}; found {listing}. Submit the notebook under its '
            'own name.'
        )
    size = path.stat().st_size
    if size > MAX_NOTEBOOK_BYTES:
        raise UnreadableSubmission(
            f'{path.name} has {size / 1e6:.0f} MB, more than {MAX_NOTEBOOK_BYTES / 1e6:.0f} MB: '
            'choose "Clear Outputs of All Cells" in JupyterLab, save, and submit again.'
        )
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise UnreadableSubmission(f'{path.name} could not be read: {error.strerror}.') from None
    try:
        return json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise UnreadableSubmission(_why_no_json(path.name, raw, error)) from None


def _why_no_json(name: str, raw: bytes, error: Exception) -> str:
    if not raw:
        return f'{name} is empty: save the lesson in JupyterLab and submit it again.'
    if conflict := _CONFLICT.search(raw):
        line = raw.count(b'\n', 0, conflict.start()) + 1
        return (
            f'{name} has a merge conflict of Git in line {line}: submit one of the two versions '
            'alone; git checkout takes it, with --ours or --theirs.'
        )
    if raw.lstrip(_SPACE)[:1] == b'<':
        return (
            f'{name} is a web page, not a notebook: download the notebook itself, in JupyterLab '
            'with File, Download, and submit that file.'
        )
    if raw.startswith(b'PK\x03\x04'):
        return f'{name} is a zip archive: unpack it, and submit the notebook that is in it.'
    return (
        f'{name} is not JSON ({_one_line(error)}): the file is damaged or not a notebook. Save it '
        'again in JupyterLab and submit that file.'
    )


def _clean_cell(cell: dict) -> dict:
    """Keep type, source, id, grade id and pasted pictures; drop outputs and other metadata."""
    # editors on Windows may save CRLF: a locked cell would count as changed, a stub as an answer
    source = _text(cell.get('source', cell.get('input', ''))).replace('\r\n', '\n')
    cell_id = cell.get('id')
    metadata = {}
    nbgrader = cell.get('metadata')
    nbgrader = nbgrader.get('nbgrader') if isinstance(nbgrader, dict) else None
    grade_id = nbgrader.get('grade_id') if isinstance(nbgrader, dict) else None
    if isinstance(grade_id, str) and len(grade_id) <= MAX_GRADE_ID_CHARACTERS:
        metadata = {'nbgrader': {'grade_id': grade_id}}
    kind = cell.get('cell_type')
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
    return clean


def _pictures(attachments: object) -> dict[str, dict[str, str]]:
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
                    kept[_text(name)[:MAX_PICTURE_NAME_CHARACTERS]] = pictures
    return kept


def _dicts(value: object) -> list[dict]:
    return [v for v in value if isinstance(v, dict)] if isinstance(value, list) else []


def _text(value: object) -> str:
    if isinstance(value, list):
        value = ''.join(part for part in value if isinstance(part, str))
    # a lone surrogate can't be encoded for a file or a socket
    return value.encode(errors='replace').decode() if isinstance(value, str) else ''


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split())[:120] or type(error).__name__
