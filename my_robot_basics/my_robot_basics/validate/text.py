"""Make text that students wrote safe to print and to show, and cut it to a width."""

import re
import unicodedata

from wcwidth import iter_graphemes
from wcwidth import width as width_of

_JOINERS = '\u200c\u200d'
"""Not printable, but needed to write some alphabets and some emoji."""
_SELECTORS = '\u180b-\u180d\u180f\ufe00-\ufe0f\U000e0100-\U000e01ef'
"""Variation selectors, which choose another form of the character before them."""
_BLANK = re.compile('[\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0]')
"""Letters and marks in Unicode that are invisible."""
_DOUBTFUL = re.compile(f'[^\n\t -~\u00a1-\u00ac\u00ae-\u02ff\u4e00-\u9fff]|[{_SELECTORS}]')
"""Characters that need a closer check; most text has none of them."""
_SELECTOR = re.compile(f'[{_SELECTORS}]')
MOST_MARKS = 6
"""How many marks may stand above and below one letter: more would cover the lines around it. No
language needs as many."""


def printable(text: object) -> str:
    """Return one line in which escapes, controls and direction marks are written as escapes."""
    return visible(' '.join(str(text).split()))


def visible(text: str) -> str:
    """Return text in which every character is visible; its newlines and tabs stay.

    Control characters, direction marks and other invisible characters are replaced by escape
    sequences, so that nothing is concealed. Words of any language and emoji stay as they are.
    """
    return _DOUBTFUL.sub(lambda found: _spelled(text, found.start()), text)


def _spelled(text: str, place: int) -> str:
    character = text[place]
    shows = _shows(character, before=text[place - 1 : place], after=text[place + 1 : place + 2])
    if shows and not _is_piled_up(text[max(0, place - MOST_MARKS) : place + 1]):
        return character
    return character.encode('unicode_escape', 'replace').decode()


def _shows(character: str, *, before: str, after: str) -> bool:
    """Whether a character is visible, or has an effect, between these neighbours."""
    if character in _JOINERS:
        return _joins(before) and _joins(after)
    if _SELECTOR.match(character):
        return before in tuple('0123456789#*') or (_joins(before) and not _SELECTOR.match(before))
    return character.isprintable() and not _BLANK.match(character)


def _is_piled_up(last: str) -> bool:
    """Whether these characters are too many marks in a row; the last one is in question."""
    return len(last) > MOST_MARKS and all(
        unicodedata.category(each) in ('Mn', 'Me') for each in last
    )


def _joins(character: str) -> bool:
    """Whether a character's form can depend on an invisible one beside it."""
    kind = unicodedata.category(character) if character else ''
    return not character.isascii() and (kind[:1] in ('L', 'M') or kind in ('So', 'Sk', 'Sm', 'Po'))


def shorten(text: str, width: int) -> str:
    """Return at most `width` columns of a line, with an ellipsis if it was cut.

    It is cut between graphemes: an emoji of several code points stays whole.
    """
    if columns(text) <= width:
        return text
    kept, taken = '', 0
    for grapheme in iter_graphemes(text):
        taken += columns(grapheme)
        if taken >= width:
            break
        kept += grapheme
    return kept + '…'


def columns(text: str) -> int:
    """Return how many columns of a terminal a line takes; control characters take none."""
    return width_of(text, control_codes='ignore')
