"""Remove local paths from a graded notebook: of the course, its Python and the home folder."""

import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

from my_robot_basics.validate.lessons.cells import KEY
from nbformat import NotebookNode

from grader.common.checkout import ROOT

EVERYBODYS = ('/', '/usr', '/usr/local')
"""Folders that exist everywhere: they reveal nothing about this machine."""


def hide_local_paths(notebook: NotebookNode) -> None:
    """Shorten local paths in outputs and verdicts, in place, to what students have as well.

    A path into the course becomes `my_robot_basics/…`, one into its environment `.venv/…`.
    """
    for cell in notebook.cells:
        for output in cell.get('outputs', ()):
            _shorten_values(output)
        _shorten_values(cell.metadata.get(KEY, {}))


def shorten_local_paths(text: str) -> str:
    """Return text in which the folders of this machine are shortened."""
    pattern, shorter = _folders()
    return pattern.sub(lambda found: shorter[found[0]], text)


@cache
def _folders() -> tuple[re.Pattern[str], dict[str, str]]:
    """Return a pattern of the folders, longest first, and what to write instead of each."""
    names = {f'{ROOT}': '.', f'{sys.prefix}': '.venv', f'{sys.base_prefix}': 'python'}
    names[f'{Path.home()}'] = '~'
    shorter = {folder: name for folder, name in names.items() if folder not in EVERYBODYS}
    shorter |= {f'{ROOT}/': ''}
    longest_first = sorted(shorter, key=len, reverse=True)
    alternatives = '|'.join(map(re.escape, longest_first))
    # a folder's whole name: /home/ada is not a part of /home/adam
    return re.compile(rf'(?:{alternatives})(?:(?<=/)|(?![\w.-]))'), shorter


def _shorten_values(value: Any) -> None:
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in list(items):
        if isinstance(each, str):
            if not str(key).startswith('image/'):
                value[key] = shorten_local_paths(each)
        elif isinstance(each, dict | list):
            _shorten_values(each)
