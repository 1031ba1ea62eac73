"""Take out of a graded notebook where the course, its Python and its grader's home lie."""

import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

from my_robot_basics.validate.cells import KEY
from nbformat import NotebookNode

from grader.common.checkout import ROOT

EVERYBODYS = ('/', '/usr', '/usr/local')
"""Folders that tell nothing of anybody."""


def hide_local_paths(notebook: NotebookNode) -> None:
    """Shorten local paths in outputs and verdicts, in place, to what students have as well.

    `my_robot_basics/…` stays of a path into the course, `.venv/…` of one into its environment.
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
    """Return what to look for, longer folders first, and what to write instead."""
    names = {f'{ROOT}': '.', f'{sys.prefix}': '.venv', f'{sys.base_prefix}': 'python'}
    names[f'{Path.home()}'] = '~'
    shorter = {folder: name for folder, name in names.items() if folder not in EVERYBODYS}
    shorter |= {f'{ROOT}/': ''}
    longest_first = sorted(shorter, key=len, reverse=True)
    alternatives = '|'.join(map(re.escape, longest_first))
    # a folder's whole name: /home/ada is no part of /home/adam
    return re.compile(rf'(?:{alternatives})(?:(?<=/)|(?![\w.-]))'), shorter


def _shorten_values(value: Any) -> None:
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in list(items):
        if isinstance(each, str):
            if not str(key).startswith('image/'):
                value[key] = shorten_local_paths(each)
        elif isinstance(each, dict | list):
            _shorten_values(each)
