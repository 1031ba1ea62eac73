"""Translate messages of `./course`, before any package is installed that reads catalogues."""

import os
import re
from functools import cache
from pathlib import Path

VARIABLE = 'COURSE_WORDS'
"""The catalogue's path, locale/*/LC_MESSAGES/launcher.po, set by `course`; '' is English."""
_ENTRY = re.compile(r'^((?:#.*\n)*)msgid ((?:".*"\n)+)msgstr ((?:".*"\n?)+)', re.MULTILINE)


def put(template: str, **values: object) -> str:
    """Return a sentence in the user's language, with its placeholders filled in."""
    known = _read(os.environ.get(VARIABLE, ''))
    text = known.get(template, template)
    return text.format(**values) if values else text


def marked(sentence: str) -> str:
    """Mark a sentence for `./course translate`; it is translated later, where it is shown."""
    return sentence


@cache
def _read(catalogue: str) -> dict[str, str]:
    """Return the translations that are not fuzzy; none if there is no such file."""
    if not catalogue or not Path(catalogue).is_file():
        return {}
    return {
        _text(english): _text(other)
        for about, english, other in _ENTRY.findall(Path(catalogue).read_text(encoding='utf-8'))
        if _text(other) and not _is_fuzzy(about)
    }


def _is_fuzzy(about: str) -> bool:
    return any('fuzzy' in line for line in about.splitlines() if line.startswith('#,'))


def _text(lines: str) -> str:
    import json  # only needed if the language is not English

    return ''.join(map(json.loads, lines.splitlines()))
