"""Put a sentence that was made in English into another language: by what it was made from.

Checks make their sentences in English, so that a grade, a gradebook and a report do not depend on
who reads them. A sentence is translated only where it is shown: it is matched with the templates
of the code, 'no message in {seconds} s', and what stands in their places is translated the same
way. What no template fits, such as a name or what a student's code made, stays as it is.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice

from my_robot_basics.language.templates import LETTERS, PLACE, Template

SENTENCES, SPACED = '{sentence} {other}', '{one} {other}'
"""One sentence behind another one; and what begins as some template does, behind anything."""
JOINED: tuple[str, ...] = (SENTENCES, SPACED, '{one}; {other}', '{one}. {other}')
JOINED += ('{one}: {other}', '{one}, {other}', '{one} and {other}', '{one} or {other}', '({one})')
JOINED += ('{one} ({other})',)
"""How sentences are put together of others, anywhere."""
MOST_CHARACTERS = 2_000
"""No sentence of ours is longer; what a student's code made may be."""
PHRASE = 10_000
"""What counts for several words in English, one behind the other, over that for their letters."""
FEW_LETTERS = 4
"""Templates with fewer, such as '{name} is {value}', fit anything: none is part of a phrase,
unless there are quotes in it."""
MOST_TRIES = 8_000
"""How many places are tried for one sentence."""
MOST_DEEP = 12
"""How many templates may stand one in the other."""
MOST_SPACES = 40
"""At how many spaces a text may be two."""
MOST_DROPPED = 5
"""Characters that a translation may leave out, such as the s of a plural."""
MOST_SPLITS = 10
"""In how many ways one template may fit one text."""

_QUOTED = re.compile(r'`[^`]*`|\'[^\']*\'|"[^"]*"')
_HAN = '[\u3400-\u9fff（），。；：]'
_IN_HAN = re.compile(rf'({_QUOTED.pattern})|(?<={_HAN}) (?={_HAN})')
"""A space between Chinese words, beside a place: there is none; and what is quoted."""
_TWO_WORDS = re.compile(r'[^\W\d_]{2,} [^\W\d_]{2,}')
_NAME = re.compile(
    r'`[^`]*`|\'[^\']*\'|"[^"]*"|/[\w/]+|\w+\(.*?\)|\b[A-Z_]{2,}\b|\w*[\d_]\w*|\w+Error\b|NotRunnable'
    r'|\b(True|False|None|Hz|rad|nan|inf|JointState|Point|String|Int32)\b|\w+(/\w+)+|\b\w\b'
)
"""What is a name in each language, or quoted."""
_RAISED = re.compile(r'[\w.]*(Error|Exception|Interrupt)(: .*)?', re.DOTALL)
"""What Python says of an exception: it stays in English."""


@dataclass
class Sentences:
    """The templates of a language."""

    translations: Mapping[str, str]
    """Of each English template, as in the catalogues."""
    _templates: list[Template] = field(default_factory=list)
    _found: dict[str, tuple[int, tuple[int, str]]] = field(default_factory=dict)
    """The best of each text so far, for one sentence, and how deep it was looked for."""
    _starts: tuple[str, ...] = ()
    _tries: int = 0

    def __post_init__(self) -> None:
        """Take the templates apart, once."""
        templates = [
            Template.of(_with_places(english), _with_places(translation, english))
            for english, translation in self.translations.items()
            if _with_places(english) != english or PLACE.search(english)
        ]
        self._templates = sorted(
            (each for each in templates if each.literals != ('', ' ', '')),
            key=lambda each: each.letters,
            reverse=True,
        )
        starts = (*self.translations, *(each.literals[0] for each in self._templates))
        self._starts = tuple({start for start in starts if len(LETTERS.findall(start)) > 2})

    def translate(self, text: str) -> str:
        """Return a sentence in this language, or as it is where nothing fits."""
        if len(text) > MOST_CHARACTERS:
            return text
        self._found, self._tries = {}, 0
        shown = self._best(text, 0)[1]
        return text if shown == text else close_up(shown)

    def _best(self, text: str, deep: int) -> tuple[int, str]:
        """Return how many letters stay English, and the text with the fewest of them."""
        if (exact := self.translations.get(text)) is not None:
            return 0, exact
        known = self._found.get(text)
        if known is None or (known[0] > deep and known[1][0] > 0):
            best = 0 if _RAISED.fullmatch(text) else _left(text), text
            if best[0] and deep < MOST_DEEP:
                for fitted in self._fitted(text, deep + 1):
                    best = min(best, fitted, key=lambda each: each[0])
            self._found[text] = known = deep, best
        return known[1]

    def _fitted(self, text: str, deep: int) -> Iterator[tuple[int, str]]:
        for template in self._templates:
            if any(literal not in text for literal in template.literals):
                continue
            for found in islice(template.fits(text), MOST_SPLITS):
                self._tries += 1
                if self._tries > MOST_TRIES:
                    return
                if text not in found.values() and not _cuts(template, found):
                    left, shown = self._put(template, found, deep)
                    if left < PHRASE or template.letters >= FEW_LETTERS or template.quoted:
                        yield left, shown
        yield from self._at_spaces(text, deep)

    def _at_spaces(self, text: str, deep: int) -> Iterator[tuple[int, str]]:
        """Split a text behind a sentence, or before what begins as some template does."""
        for space in islice(re.finditer(' ', text), MOST_SPACES):
            before, after = text[: space.start()], text[space.end() :]
            self._tries += 1
            for joined in (SENTENCES,) * before.endswith(('.', '!', '?')) + (SPACED,):
                if joined == SENTENCES or after.startswith(self._starts):
                    template = Template.of(joined, self.translations.get(joined, joined))
                    found = dict(zip(template.places, (before, after), strict=True))
                    left, shown = self._put(template, found, deep)
                    if left < PHRASE or joined == SENTENCES:
                        yield left, shown

    def _put(self, template: Template, found: Mapping[str, str], deep: int) -> tuple[int, str]:
        """Return a template's translation with that in its places, and how much stays English."""
        best = {
            name: (0, found[name]) if name in template.quoted else self._best(found[name], deep)
            for name in template.used
        }
        shown = PLACE.sub(lambda place: best[place[1]][1], template.translation)
        return sum(left for left, _ in best.values()), shown


def _cuts(template: Template, found: Mapping[str, str]) -> bool:
    """Whether a template would cut a sentence or a bracket in two, or leave a place empty."""
    said = {place: _QUOTED.sub('', text) for place, text in found.items()}
    ended = any('. ' in said[place] for place in template.places[:-1]) and template.letters > 0
    named = {place for place in template.used if not place.startswith('value')}
    if any('`' in found[place] for place in template.quoted):
        return True
    if '' not in template.literals[1:-1] and any(not found[place] for place in named):
        return True
    if any(
        len(text) > MOST_DROPPED for place, text in found.items() if place not in template.used
    ):
        return True
    return ended or any(
        text.count('(') != text.count(')') and '…' not in text for text in said.values()
    )


def close_up(text: str) -> str:
    """Return a text without spaces between Chinese words, but for what is quoted."""
    return _IN_HAN.sub(lambda found: found[1] or '', text)


def _with_places(text: str, english: str = '') -> str:
    """Return a beginning or an end, such as 'your cell ', with a place for what it belongs to."""
    english = english or text
    if english[-1:] == ' ' and english.strip():
        return text + '{rest}'
    return '{rest}' + text if english[:1] in ' ,;' and english.strip() else text


def _left(text: str) -> int:
    """Count the letters of a text that may be words: names and what is quoted are none."""
    unknown = _NAME.sub('', text)
    return len(LETTERS.findall(unknown)) + PHRASE * bool(_TWO_WORDS.search(unknown))
