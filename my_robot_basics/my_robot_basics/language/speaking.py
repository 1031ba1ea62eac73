"""Show the software's sentences in the language of a notebook."""

import os
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from my_robot_basics.language.catalogues import ENGLISH, LOCALE, languages, read_translations
from my_robot_basics.language.sentences import Sentences

FOR_STUDENTS = ('checks', 'validate', 'lesson_checks', 'quiz', 'live', 'doctor')
"""The catalogues of the software that students have, and of the checks that they may read."""
PARTS = (*FOR_STUDENTS, 'hidden_checks', 'feedback')
KEY, LANGUAGE = 'my_robot_basics', 'language'
"""The keys of a notebook's language in its metadata, if it is not English."""
OF_TERMINALS = 'COURSE_LANGUAGE'
"""The environment variable with a terminal's language; `./course` sets it."""


def language_of(metadata: Mapping) -> str:
    """Return the language in a notebook's metadata; English if that has no catalogues."""
    ours = metadata.get(KEY)
    said = ours.get(LANGUAGE) if isinstance(ours, Mapping) else None
    return said if isinstance(said, str) and said in languages(LOCALE) else ENGLISH


def language_here() -> str:
    """Return the language of this process: in a notebook's kernel, that of its edition's folder.

    In a terminal, it is the one that `./course` has chosen.
    """
    known = languages(LOCALE)
    opened = os.environ.get('JPY_SESSION_NAME')
    parts = Path(opened).parts if opened else (os.environ.get(OF_TERMINALS, ''),)
    return next((part for part in parts if part in known), ENGLISH)


def in_language_here(text: str) -> str:
    """Return a sentence of the software in the language of this kernel or terminal."""
    return in_language(language_here(), text)


def in_language(language: str, text: str) -> str:
    """Return a sentence of the software in a language, or unchanged without a translation."""
    return text if language == ENGLISH else sentences(language).translate(text)


def put(language: str, template: str, **values: object) -> str:
    """Return a template's translation with the values filled in."""
    known = {} if language == ENGLISH else sentences(language).translations
    return known.get(template, template).format(**values)


@cache
def sentences(language: str) -> Sentences:
    """Return the translations of all catalogues of the software in a language."""
    known: dict[str, str] = {}
    for part in PARTS:
        known |= read_translations(LOCALE, language, part)
    return Sentences(known)
