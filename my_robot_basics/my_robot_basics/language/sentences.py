"""Translate finished English sentences by matching them with the templates that they come from.

Checks make their sentences in English, so that a grade, a gradebook and a report do not depend on
who reads them. A sentence is translated only when it is shown: it is matched with the templates
of the code, such as 'no message in {seconds} s', and the texts in their places are translated the
same way. A text that no template fits, such as a name or a student's output, stays as it is.
"""

import re
from collections.abc import Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field
from itertools import islice

from my_robot_basics.language.cuts import is_cut, is_exception_cut, is_open
from my_robot_basics.language.english import (
    IN_BRACKETS,
    PHRASE,
    is_raised,
    letters_in_names,
    letters_left,
    split_line,
)
from my_robot_basics.language.spaces import remove_spaces
from my_robot_basics.language.templates import CODE, FEW_LETTERS, LETTERS, PLACE, Template

SENTENCES, SPACED = '{sentence} {other}', '{one} {other}'
"""Two sentences in a row; and any text followed by one that begins like some template."""
REASON, CLAUSES = 'expected {expected}, saw {seen}: {hint}', '{one}; {other}'
JOINED: tuple[str, ...] = (SENTENCES, SPACED, CLAUSES, '{one}. {other}')
JOINED += ('{one}: {other}', '{one}, {other}', '{one} and {other}', '{one} or {other}', '({one})')
JOINED += (IN_BRACKETS,)
"""Templates that join any two texts, or put one into brackets."""
MOST_CHARACTERS = 2_000
"""Longer texts are not translated: only a student's output makes a sentence so long."""
MOST_TRIES = 8_000
"""How many matches are tried for one sentence."""
MOST_DEEP = 12
"""How deep templates may be nested."""
MOST_SPACES = 40
"""At how many spaces it is tried to split a text."""
MOST_SPLITS = 10
"""How many matches of one template with one text are tried."""

OF_CODE = 1e-4
"""What a place with code costs: of two matches, the one with less code is taken."""

_HOW_MANY = re.compile(r'(n|len|count|exit_code|number|lineno|line_number)\d*')
"""Names of places that only a number, or `…` for a hidden one, may fill: `{len} wrong`."""
_NUMBER = re.compile(r'[\d,.]+|…')


@dataclass
class Sentences:
    """Translates sentences into one language."""

    translations: Mapping[str, str]
    """The translation of each English template, as in the catalogues."""
    _templates: list[Template] = field(default_factory=list)
    _found: dict[str, tuple[int, tuple[float, str]]] = field(default_factory=dict)
    """For the current sentence: each text's best translation so far, and its nesting depth."""
    _first: tuple[Template, ...] = ()
    """REASON and CLAUSES, which are tried first: their parts take far fewer tries."""
    _starts: tuple[str, ...] = ()
    _tries: int = 0

    def __post_init__(self) -> None:
        """Parse the templates once."""
        templates = [
            Template.of(_with_places(english), _with_places(translation, english))
            for english, translation in self.translations.items()
            if _with_places(english) != english or PLACE.search(english)
        ]
        self._templates = sorted(
            (each for each in templates if each.literals != ('', ' ', '')),
            key=lambda each: (each.letters, sum(map(len, each.literals))),  # signs: `{name}`
            reverse=True,
        )
        first = (Template.of(each, '').literals for each in (REASON, CLAUSES))
        self._first = tuple(t for literals in first for t in templates if t.literals == literals)
        starts = (*self.translations, *(each.literals[0] for each in self._templates))
        self._starts = tuple({start for start in starts if len(LETTERS.findall(start)) > 2})

    def translate(self, text: str) -> str:
        """Return a sentence in this language, or unchanged if nothing fits."""
        if len(text) > MOST_CHARACTERS:
            return text
        shown = self._search()._best(text, 0)[1]
        return text if shown == text else remove_spaces(shown)

    def parts(self, english: str, text: str) -> dict[str, str]:
        """Return the translated text of each of the template's places in `text`.

        Of several matches, it is the one that leaves the least in English; {} if none fits.
        """
        template = Template.of(english, english)
        search, least, parts = self._search(), 0.0, dict[str, str]()
        for found in islice(template.fits(text[:MOST_CHARACTERS]), MOST_SPLITS):
            if self._is_cut(template, found):
                continue
            best = {name: search._best(said, 0) for name, said in found.items()}
            left = sum(each for each, _ in best.values())
            if not parts or left < least:
                least, parts = (
                    left,
                    {name: remove_spaces(shown) for name, (_, shown) in best.items()},
                )
        return parts

    def _search(self) -> 'Sentences':
        """Return a copy with a search of its own: nodes' threads translate at the same time."""
        search = copy(self)
        search._found, search._tries = {}, 0
        return search

    def _best(self, text: str, deep: int) -> tuple[float, str]:
        """Return the translation with the fewest letters in English, after that number."""
        if (exact := self.translations.get(text)) is not None:
            return 0, exact
        known = self._found.get(text)
        if known is None or (known[0] > deep and known[1][0] > 0):
            raised = is_raised(text)
            best = self._raised(text, deep) if raised else (letters_left(text), text)
            if best[0] and not raised and deep < MOST_DEEP:
                for fitted in self._fitted(text, deep + 1):
                    best = min(best, fitted, key=lambda each: each[0])
                    if not best[0]:
                        break
            self._found[text] = known = deep, best
        return known[1]

    def _raised(self, text: str, deep: int) -> tuple[float, str]:
        """Translate the line where an exception was raised, and nothing of what Python says."""
        said, line = split_line(text)
        if line:
            joined = self.translations.get(IN_BRACKETS, IN_BRACKETS)
            said = joined.format(one=said, other=self._best(line, deep + 1)[1])
        return letters_in_names(text), said

    def _fitted(self, text: str, deep: int) -> Iterator[tuple[float, str]]:
        for template in (*self._first, *self._templates):
            if any(literal not in text for literal in template.literals):
                continue
            for found in islice(template.fits(text), MOST_SPLITS):
                self._tries += 1
                if self._tries > MOST_TRIES:
                    return
                if text not in found.values() and not self._is_cut(template, found):
                    left, shown = self._put(template, found, deep)
                    if left < PHRASE or template.letters >= FEW_LETTERS or template.quoted:
                        yield left, shown
        yield from self._at_spaces(text, deep)

    def _at_spaces(self, text: str, deep: int) -> Iterator[tuple[float, str]]:
        """Split a text after a sentence, or before words with which some template begins."""
        for space in islice(re.finditer(' ', text), MOST_SPACES):
            before, after = text[: space.start()], text[space.end() :]
            self._tries += 1
            ended = before.endswith(('.', '!', '?'))
            for joined in (SENTENCES,) * ended + (SPACED,) * (not is_open(before)):
                if joined == SENTENCES or after.startswith(self._starts):
                    template = Template.of(joined, self.translations.get(joined, joined))
                    found = dict(zip(template.places, (before, after), strict=True))
                    left, shown = self._put(template, found, deep)
                    if left < PHRASE or joined == SENTENCES:
                        yield left, shown

    def _is_cut(self, template: Template, found: Mapping[str, str]) -> bool:
        """Whether a match cuts a phrase, or puts a phrase in the place of a name or number."""
        for place, text in found.items():
            if _HOW_MANY.fullmatch(place) and not _NUMBER.fullmatch(text):
                return True
            known = text in self.translations or text.strip() in self.translations
            if (place.isupper() and ' ' in text.strip() and not known) or (
                place.endswith('name')
                and (': ' in text or (', ' in text and place not in template.quoted))
            ):
                return True
        return is_cut(template, found) or is_exception_cut(template, found, self._starts)

    def _put(self, template: Template, found: Mapping[str, str], deep: int) -> tuple[float, str]:
        """Fill a template's translation; return the letters that stay English, and the text."""
        best: dict[str, tuple[float, str]] = {}
        for name in filter(template.used.__contains__, template.places):
            if name in template.quoted:
                best[name] = 0, found[name]
            elif CODE.fullmatch(name):
                best[name] = OF_CODE, found[name]
            else:
                best[name] = self._best(found[name], deep)
        shown = PLACE.sub(lambda place: best[place[1]][1], template.translation)
        return sum(left for left, _ in best.values()), shown


def _with_places(text: str, english: str = '') -> str:
    """Add the place {rest} to a prefix or suffix, such as 'your cell '."""
    english = english or text
    if english[-1:] == ' ' and english.strip():
        return text + '{rest}'
    return '{rest}' + text if english[:1] in ' ,;' and english.strip() else text
