"""What a sentence is made from: words, and places for what differs each time."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

PLACE = re.compile(r'\{(\w*)\}')
LETTERS = re.compile(r'[^\W\d_]')
FEW_LETTERS = 4
"""Templates with fewer, such as '{name} is {value}', fit anything: none is part of a phrase,
unless there are quotes in it."""
_WORD = re.compile(r'[^\s,;(]*')
_QUOTES = tuple('`\'"')
"""Between “these” stands what the course calls something."""


@dataclass(frozen=True)
class Template:
    """What a sentence is made from, and its translation."""

    literals: tuple[str, ...]
    """What stands before, between and behind its places."""
    places: tuple[str, ...]
    translation: str

    @property
    def used(self) -> set[str]:
        """The places that the translation has, too."""
        return {*PLACE.findall(self.translation)}

    @classmethod
    def of(cls, english: str, translation: str) -> 'Template':
        """Take an English template apart."""
        pieces = PLACE.split(english)
        return cls(tuple(pieces[::2]), tuple(pieces[1::2]), translation)

    @property
    def letters(self) -> int:
        """How much of it is words of its own: the more, the better it fits what it fits."""
        return len(LETTERS.findall(''.join(self.literals)))

    @property
    def quoted(self) -> set[str]:
        """The places between quotes: what stands there is somebody else's."""
        return {
            place
            for n, (place, before) in enumerate(zip(self.places, self.literals, strict=False))
            # a backtick may as well be the end of a name, with a place right behind it
            if before.endswith(_QUOTES)
            and not (before == '`' and ''.join(self.literals[: n + 1]).count('`') % 2 == 0)
        }

    def fits(self, text: str) -> Iterator[dict[str, str]]:
        """Yield what may stand in its places, for each way in which it fits a text."""
        first, *between = self.literals
        if text.startswith(first) and text.endswith(between[-1]):
            yield from self._splits(text[len(first) :], between, self.places)

    def _splits(
        self, text: str, literals: list[str], places: tuple[str, ...]
    ) -> Iterator[dict[str, str]]:
        literal, *others = literals
        if not others:
            if text.endswith(literal):
                yield {places[0]: text.removesuffix(literal)}
            return
        if not literal:  # two places without anything between them: a word is in the first
            at = len(_WORD.match(text)[0])  # type: ignore[index]  # it matches anything
            for found in self._splits(text[at:], others, places[1:]):
                yield {places[0]: text[:at], **found}
            return
        at = text.find(literal)
        while at >= 0:
            has_fitted = False
            for found in self._splits(text[at + len(literal) :], others, places[1:]):
                has_fitted = True
                yield {places[0]: text[:at], **found}
            if not has_fitted:  # nor does it behind a later place
                return
            at = text.find(literal, at + 1)
