"""Translate a picture's alternative text, clause by clause.

Names from the lesson's code, such as that of a row in a timeline, are not translated: the
picture shows them, too.
"""

import re
from functools import cache, lru_cache
from pathlib import Path

from my_robot_basics.language.catalogues import ENGLISH, LOCALE, read_translations
from my_robot_basics.language.english import letters_left
from my_robot_basics.language.sentences import CLAUSES, JOINED, Sentences

PICTURES, DOCTOR, CHECKS = 'pictures', 'doctor', 'checks'
"""The catalogues of alternative texts, of the doctor's sentences in them, and of JOINED."""
COLON = '{one}: {other}'
CLAUSE = '; '
"""Separates two clauses, and two lines if the text has to be one line."""

_HAN = re.compile('[\u3400-\u9fff]+')


def translate_alt_text(language: str, text: str, locale: Path = LOCALE) -> str:
    """Translate an alternative text line by line; what has no translation stays English."""
    return text if language == ENGLISH else _translated(locale, language, text)


def join_alt_text_lines(language: str, text: str, locale: Path = LOCALE) -> str:
    """Join the lines of an alternative text into one, for the attribute `alt`."""
    between = CLAUSE if language == ENGLISH else _joined(locale, language, CLAUSES)
    return between.join(text.split('\n'))


@lru_cache(maxsize=100)
def _translated(locale: Path, language: str, text: str) -> str:
    sentences, between = _sentences(locale, language), _joined(locale, language, CLAUSES)
    return '\n'.join(
        between.join(_clause(sentences, clause) for clause in line.split(CLAUSE))
        for line in text.split('\n')
    )


def _clause(sentences: Sentences, clause: str) -> str:
    """Translate a clause as a whole, or each of its parts between colons."""
    whole = sentences.translate(clause)
    if ': ' not in clause:
        return whole
    parts = clause.split(': ')
    put = [sentences.translate(part) for part in parts]
    if put == parts and _left(whole):
        return whole  # it is not a text of the course
    colon = sentences.translations.get(COLON, COLON)
    shown = colon.format(one='', other='').join(put)
    return min(shown, whole, key=_left)


def _left(text: str) -> int:
    return letters_left(_HAN.sub('，', text))


def _joined(locale: Path, language: str, form: str) -> str:
    known = _sentences(locale, language).translations
    return known.get(form, form).format(one='', other='')


@cache
def _sentences(locale: Path, language: str) -> Sentences:
    known = {
        english.removeprefix(CLAUSE): translation.lstrip('；; ')
        for english, translation in read_translations(locale, language, DOCTOR).items()
    }
    joined = read_translations(locale, language, CHECKS)
    known |= {form: joined[form] for form in JOINED if form in joined}
    return Sentences(known | read_translations(locale, language, PICTURES))
