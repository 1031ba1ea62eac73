"""Templates of sentences: fixed words, and places for the parts that vary."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

PLACE = re.compile(r'\{(\w*)\}')
LETTERS = re.compile(r'[^\W\d_]')
FEW_LETTERS = 4
"""Templates with fewer letters, such as '{name} is {value}', fit almost anything: such a match
counts only if it leaves no English phrase, or if the template has quotes."""
_WORD = re.compile(r'[^\s,;(]*')
CODE = re.compile(r'(code|call|function_name|msg)\d*')
"""Names of places for code, a function's name or Python's message: they are not translated."""
_QUOTES = tuple('`\'"')
"""A place after one of these is a name, which is not translated."""


@dataclass(frozen=True)
class Template:
    """An English template, parsed, and its translation."""

    literals: tuple[str, ...]
    """The fixed texts before, between and after its places."""
    places: tuple[str, ...]
    translation: str

    @property
    def used(self) -> set[str]:
        """The places that the translation uses."""
        return {*PLACE.findall(self.translation)}

    @classmethod
    def of(cls, english: str, translation: str) -> 'Template':
        """Parse an English template."""
        pieces = PLACE.split(english)
        return cls(tuple(pieces[::2]), tuple(pieces[1::2]), translation)

    @property
    def letters(self) -> int:
        """How many letters its fixed texts have: the more, the more certain is a match."""
        return len(LETTERS.findall(''.join(self.literals)))

    @property
    def quoted(self) -> set[str]:
        """The places between quotes: their texts are names, and are not translated."""
        return {
            place
            for n, (place, before) in enumerate(zip(self.places, self.literals, strict=False))
            # a backtick may also be the closing one of a name, directly before the place
            if before.endswith(_QUOTES)
            and not (before == '`' and ''.join(self.literals[: n + 1]).count('`') % 2 == 0)
        }

    def fits(self, text: str) -> Iterator[dict[str, str]]:
        """Yield the text of each place, for each way in which the template matches a text."""
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
        if not literal:  # nothing between two places: the first one takes a single word
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
            if not has_fitted:  # the rest will not match after a later occurrence, either
                return
            at = text.find(literal, at + 1)
