"""Reject matches of a template that would cut a text in the middle of a phrase."""

import re
from collections.abc import Mapping

from my_robot_basics.language.spaces import QUOTED
from my_robot_basics.language.templates import CODE, FEW_LETTERS, LETTERS, Template

MOST_DROPPED = 5
"""Characters that a translation may leave out, such as the s of a plural."""

_OPENED = re.compile(r'(?<!\w)[\'"](?=\w)')
"""An opening quote; closed quotes are removed before the search."""
_LINE = re.compile(r'\((\S+, )?line \d+(, in \S+)?: .*?\)(?=$|[,;:] )')
"""A line of code in brackets: of a longer statement, it may have half of a pair of brackets."""
_RAISES = re.compile(r'(Error|Exception|Interrupt|Exit):( |$)')
"""The name of an exception: Python's own message follows, with any colons and brackets."""


def is_cut(template: Template, found: Mapping[str, str]) -> bool:
    """Whether a match cuts a sentence, a quote or a pair of brackets, or leaves a place empty."""
    said = {place: QUOTED.sub('', text) for place, text in found.items()}
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
        '…' not in text and _cuts(text) and _cuts(QUOTED.sub('', _LINE.sub('', found[place])))
        for place, text in said.items()
        if not CODE.fullmatch(place)
    )


def _cuts(text: str) -> bool:
    """Whether a text has only one half of a pair of brackets or quotes."""
    counts = ((text.count(one), text.count(other)) for one, other in ('()', '[]', '{}'))
    return any(one != other for one, other in counts) or bool(_OPENED.search(text))


def is_exception_cut(
    template: Template, found: Mapping[str, str], starts: tuple[str, ...]
) -> bool:
    """Whether a match cuts the message of an exception before its end.

    The message ends where the course's words follow: the template's, or one of `starts`.
    """
    pairs = zip(template.places, template.places[1:], template.literals[1:], strict=False)
    return any(
        _RAISES.search(found[place])
        and (found[place].endswith(':') or not _is_ours(literal, found[other], starts))
        for place, other, literal in pairs
    )


def is_open(text: str) -> bool:
    """Whether a text is incomplete: it ends with a colon, or contains an exception's name."""
    return text.endswith(':') or bool(_RAISES.search(text))


def _is_ours(literal: str, after: str, starts: tuple[str, ...]) -> bool:
    letters = len(LETTERS.findall(literal))
    return letters >= FEW_LETTERS or (not letters and after.startswith(('`', *starts)))
