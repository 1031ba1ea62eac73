"""Translate messages of `./course`, before any package is installed that reads catalogues."""

import os

VARIABLE = 'COURSE_WORDS'
"""The catalogue's path, locale/*/LC_MESSAGES/launcher.po, set by `course`; '' is English."""
_ENTRY = r'(?m)^((?:#.*\n)*)msgid ((?:".*"\n)+)msgstr ((?:".*"\n?)+)'
_known: dict[str, dict[str, str]] = {}
"""The translations of each catalogue that was read."""


def put(template: str, **values: object) -> str:
    """Return a sentence in the user's language, with its placeholders filled in."""
    catalogue = os.environ.get(VARIABLE, '')
    if catalogue and catalogue not in _known:
        _known[catalogue] = _read(catalogue)
    text = _known.get(catalogue, {}).get(template, template)
    return text.format(**values) if values else text


def gettext_noop(sentence: str) -> str:
    """Mark a sentence for `./course translate`; it is translated later, where it is shown."""
    return sentence


def _read(catalogue: str) -> dict[str, str]:
    """Return the translations that are not fuzzy; none if there is no such file."""
    import re  # only needed if the language is not English

    if not os.path.isfile(catalogue):
        return {}
    with open(catalogue, encoding='utf-8') as file:
        entries = re.findall(_ENTRY, file.read())
    return {
        _text(english): _text(other)
        for about, english, other in entries
        if _text(other) and not _is_fuzzy(about)
    }


def _is_fuzzy(about: str) -> bool:
    return any('fuzzy' in line for line in about.splitlines() if line.startswith('#,'))


def _text(lines: str) -> str:
    import json  # only needed if the language is not English

    return ''.join(map(json.loads, lines.splitlines()))
