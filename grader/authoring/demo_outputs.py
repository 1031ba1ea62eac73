"""Store the outputs of demonstrations in one place, so that a changed sentence is a small diff.

notebooks/ has their pictures and measured values. solutions/ has what nbval compares, in the form
in which nbval compares it: without pixels, and without what differs from run to run.
"""

import configparser
import copy
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from nbformat import NotebookNode

Sanitize = Callable[[str], str]

PICTURE = 'image/png'
DIFFERS = 'nbval-ignore-output'
"""The tag of a cell whose outputs differ each time: solutions/ stores no outputs of it."""


def read_sanitizer(path: Path) -> Sanitize:
    """Return a function that replaces what may differ between runs, by nbval's rules."""
    parser = configparser.RawConfigParser()
    parser.read(path, encoding='utf-8')  # without the file, there are no such rules
    rules = [
        (re.compile(section['regex']), section.get('replace', ''))
        for name, section in parser.items()
        if name != parser.default_section
    ]

    def sanitize(text: str) -> str:
        for pattern, replacement in rules:
            text = pattern.sub(replacement, text)
        return text

    return sanitize


def clean_source(source: NotebookNode, sanitize: Sanitize) -> NotebookNode:
    """Return an instructor's notebook in its stored form: outputs as nbval compares them."""
    cleaned = copy.deepcopy(source)
    cleaned.metadata.pop('widgets', None)
    if 'language_info' in cleaned.metadata:  # it has the version of the Python that ran it
        cleaned.metadata.language_info = NotebookNode(name=cleaned.metadata.language_info.name)
    for cell in cleaned.cells:
        cell.metadata.pop('execution', None)  # start and end times
        if cell.cell_type == 'code':
            cell.outputs = [] if _differs(cell) else _sanitized(cell.outputs, sanitize)
    return cleaned


def keep_outputs(
    built: NotebookNode, released: NotebookNode, sanitize: Sanitize, *, fresh: bool = False
) -> list[str]:
    """Copy outputs of the last release into a new one, if they are still valid.

    They are valid if nbval would accept the new outputs as the same. If a cell's code has changed
    and the cell was run again, or, with `fresh`, if it was run, the new outputs are used. Returns
    the cells whose pictures are missing, or older than the last change of their code.
    """
    before = {cell.id: cell for cell in released.cells}
    doubtful = []
    for cell in filter(_is_demo, built.cells):
        old = before.get(cell.id)
        changed = old is None or old.source != cell.source
        if old is None or not _still_hold(cell, old, sanitize):
            doubtful += [cell.id] * any(map(_lacks_picture, cell.outputs))
        elif not ((changed or fresh) and _was_run(cell, sanitize)):
            cell.outputs = old.get('outputs', [])
            doubtful += [cell.id] * (changed and any(map(_has_picture, cell.outputs)))
        for output in filter(_is_in_page, cell.outputs):
            output.data.pop(PICTURE, None)  # the HTML has the same picture, with a description
    return doubtful


def _still_hold(cell: NotebookNode, old: NotebookNode, sanitize: Sanitize) -> bool:
    if _differs(cell):
        return True
    ours, theirs = (list(_words(each.get('outputs', []), sanitize)) for each in (cell, old))
    return ours == theirs


def _words(outputs: list[NotebookNode], sanitize: Sanitize) -> Iterator[str]:
    """Yield the text of each output; for a picture, its description."""
    for output in outputs:
        data = output.get('data', {})
        said = sanitize(output.get('text') or data.get('text/plain') or data.get('text/html', ''))
        if said.strip():
            yield said


def _was_run(cell: NotebookNode, sanitize: Sanitize) -> bool:
    """Whether a cell's outputs come from a run, not from the stored form in solutions/."""
    stored = [] if _differs(cell) else _sanitized(cell.outputs, sanitize)
    return cell.outputs != stored


def _sanitized(outputs: list[NotebookNode], sanitize: Sanitize) -> list[NotebookNode]:
    cleaned = copy.deepcopy(outputs)
    for output in cleaned:
        if 'text' in output:
            output.text = sanitize(output.text)
        data = output.get('data', {})
        if data.pop(PICTURE, None):
            output.metadata.setdefault(PICTURE, NotebookNode())  # marks that there was one
        for mime, text in data.items():
            data[mime] = sanitize(text) if isinstance(text, str) else text
    return cleaned


def _is_demo(cell: NotebookNode) -> bool:
    return cell.cell_type == 'code' and 'demo' in cell.metadata.get('tags', ())


def _differs(cell: NotebookNode) -> bool:
    return DIFFERS in cell.metadata.get('tags', ())


def _has_picture(output: NotebookNode) -> bool:
    return PICTURE in output.get('data', {}) or _is_in_page(output)


def _is_in_page(output: NotebookNode) -> bool:
    return f'src="data:{PICTURE};' in output.get('data', {}).get('text/html', '')


def _lacks_picture(output: NotebookNode) -> bool:
    return PICTURE in output.get('metadata', {}) and not _has_picture(output)
