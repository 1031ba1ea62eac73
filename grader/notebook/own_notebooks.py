"""Notebooks that this grader has written itself."""

import nbformat
import nbformat.reader
from nbformat import NotebookNode


def parse_own_notebook(text: str) -> NotebookNode:
    """Return a notebook from its file's text. Raises ValueError if it is not one.

    nbformat.read would validate all of it each time, and only log what is wrong.
    """
    try:
        notebook = nbformat.reader.reads(text)
    except (AttributeError, TypeError, nbformat.ValidationError) as error:
        raise ValueError(f'no notebook: {error}') from None
    if notebook.get('nbformat') != nbformat.current_nbformat:
        raise ValueError('a notebook of another format')
    return notebook
