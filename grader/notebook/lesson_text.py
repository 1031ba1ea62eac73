"""Read lessons: a run reads each a dozen times, and few of them are new since the last run."""

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
"""In the gradebook: of which texts it is known that they are notebooks. To check one takes longer
than to read it ten times. What is removed there is made again."""
MOST_KEPT = 200
MOST_SAID = 100
"""Characters of what is wrong: it may begin with all of a cell."""


def read_lesson(text: str, gradebook: Path) -> NotebookNode:
    """Return the notebook that a text holds. Raises ValueError, which says why, where it is none.

    What was valid once is not checked again; the gradebook's folder remembers it, where it is.
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
        return []  # none yet, or damaged
    return [each for each in known if isinstance(each, str)] if isinstance(known, list) else []


def _remember(digests: list[str], gradebook: Path) -> None:
    # without a gradebook, or without a place in it, the next run takes longer
    with contextlib.suppress(OSError):
        write_whole(gradebook / KEPT, json.dumps(digests[-MOST_KEPT:]))
