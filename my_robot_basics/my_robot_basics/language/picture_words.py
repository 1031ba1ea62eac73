"""Put a picture's alternative text into another language, clause by clause.

What the lesson's code calls something, as a row of a timeline, stays as it is: the picture shows
it so.
"""

import re
from functools import cache, lru_cache
from pathlib import Path

from my_robot_basics.language.catalogues import ENGLISH, LOCALE, read_translations
from my_robot_basics.language.english import letters_left
from my_robot_basics.language.sentences import CLAUSES, JOINED, Sentences

PICTURES, DOCTOR, CHECKS = 'pictures', 'doctor', 'checks'
"""The catalogues of these texts, of what the doctor says in one, and of how parts are joined."""
COLON = '{one}: {other}'
CLAUSE = '; '
"""Between two clauses, as between two lines where the text is one line."""

_HAN = re.compile('[\u3400-\u9fff]+')


def picture_in(language: str, text: str, locale: Path = LOCALE) -> str:
    """Return an alternative text in a language, line by line; what is not translated stays."""
    return text if language == ENGLISH else _translated(locale, language, text)


def in_one_line(language: str, text: str, locale: Path = LOCALE) -> str:
    """Return the lines of an alternative text one behind the other, as `alt` takes them."""
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
    """Translate a clause as a whole, or what stands before and behind each colon in it."""
    whole = sentences.translate(clause)
    if ': ' not in clause:
        return whole
    parts = clause.split(': ')
    put = [sentences.translate(part) for part in parts]
    if put == parts and _left(whole):
        return whole  # it is not the course's
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
