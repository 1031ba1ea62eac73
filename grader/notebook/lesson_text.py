"""Read lessons fast: a run reads each a dozen times, and few have changed since the last run."""

import contextlib
import hashlib
import json
import pickle
from functools import lru_cache
from pathlib import Path

import nbformat
import nbformat.reader
from nbformat import NotebookNode

from grader.common.files import write_whole
from grader.common.text import printable

KEPT = 'valid_lessons.json'
"""A file in the gradebook with hashes of lessons that are valid notebooks. To validate one takes
ten times as long as to read it. If the file is removed, it is made again."""
MOST_KEPT = 200
MOST_SAID = 100
"""How much of an error message is kept: it may quote a whole cell."""


def read_lesson(text: str, gradebook: Path) -> NotebookNode:
    """Return the notebook in a text. Raises ValueError with the reason if it is not a notebook.

    A text that was valid before is not validated again; the gradebook's folder stores its hash.
    """
    return pickle.loads(_packed(text, gradebook))


@lru_cache(maxsize=64)
def _packed(text: str, gradebook: Path) -> bytes:
    digest = hashlib.sha256(f'{nbformat.__version__}\n{text}'.encode()).hexdigest()
    known = _known(gradebook / KEPT)
    try:
        notebook = nbformat.reader.reads(text)
        if digest not in known:
            checked = nbformat.convert(notebook, nbformat.current_nbformat)
            nbformat.validate(checked)  # it adds what is missing, such as IDs
            if checked == nbformat.reader.reads(text):
                _remember([*known, digest], gradebook)
            notebook = checked
    except nbformat.ValidationError as error:
        place = '.'.join(map(str, getattr(error, 'absolute_path', ())))
        where = f' (at {place})' if place else ''
        raise ValueError(f'{_line(error)}{where}') from None
    except (AssertionError, AttributeError, RecursionError, TypeError) as error:
        said = f'its parts have other types than those of a notebook ({_line(error)})'
        raise ValueError(said) from None
    return pickle.dumps(notebook, pickle.HIGHEST_PROTOCOL)


def _line(error: Exception) -> str:
    said = printable((str(error) or type(error).__name__).splitlines()[0])
    return said if len(said) <= MOST_SAID else f'…{said[-MOST_SAID:]}'


def _known(path: Path) -> list[str]:
    try:
        known = json.loads(path.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return []  # not there yet, or damaged
    return [each for each in known if isinstance(each, str)] if isinstance(known, list) else []


def _remember(digests: list[str], gradebook: Path) -> None:
    # if the gradebook does not exist or is full, the next run validates again
    with contextlib.suppress(OSError):
        write_whole(gradebook / KEPT, json.dumps(digests[-MOST_KEPT:]))
