"""The forms of names that tell a student and an assignment: STUDENT_ASSIGNMENT, the exchange's."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from grader.collect.archive_entries import ARCHIVE
from grader.collect.platforms import label_in

_BETWEEN = '_+- .'
"""What may stand between a student's name and an assignment's."""


@dataclass(frozen=True)
class AssignmentName:
    """A name that ends with an assignment's."""

    who: str
    what: str


@dataclass(frozen=True)
class ExchangeName(AssignmentName):
    """The name of a folder of nbgrader's exchange."""

    when: str


class NameForms:
    """Names that hold one of the assignments'."""

    def __init__(self, assignments: Iterable[str]) -> None:
        self._known = sorted(assignments, key=len, reverse=True)
        one_of = '|'.join(map(re.escape, self._known)) or '(?!)'
        self._exchange = re.compile(
            rf'(?P<who>.+)\+(?P<what>{one_of})\+(?P<when>\d{{4}}-[^+]+)(\+[\w=-]+)?'
        )

    def named(self, name: str) -> AssignmentName | None:
        """Split STUDENT_ASSIGNMENT, and STUDENT_ASSIGNMENT-1; None where it is no such name.

        A regular expression would take a time that grows with the square of a name's length.
        """
        for whole in (name, re.sub(r'(?<=\w)-\d+$', '', name)):
            for what in self._known:
                who = whole.removesuffix(what)
                if who != whole and len(who) > 1 and who[-1] in _BETWEEN:
                    return AssignmentName(who.rstrip(_BETWEEN) or who[0], what)
        return None

    def exchanged(self, name: str) -> ExchangeName | None:
        """Split STUDENT+ASSIGNMENT+TIME; None where it is no such name."""
        found = self._exchange.fullmatch(name)
        return ExchangeName(found['who'], found['what'], found['when']) if found else None

    def who(self, name: str) -> str:
        """Return whom a folder or an archive may be named after."""
        found = label_in(name) or self.exchanged(name) or self.named(bare(name))
        return found.who if found else bare(name)


def stem_of(name: str) -> str:
    """Return a notebook's name without its ending, and what a browser put before that."""
    return re.sub(r' \(\d+\)$', '', name[: -len('.ipynb')])


def bare(name: str) -> str:
    """Return a folder's or an archive's name without what a program added at its end."""
    if not ARCHIVE.search(name):
        return name
    return re.sub(r' \(\d+\)$', '', ARCHIVE.sub('', name))


def shared_folders(folders: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Return the folders in which everything lies."""
    if not folders:
        return ()
    low, high = min(folders), max(folders)
    alike = [a == b for a, b in zip(low, high, strict=False)]
    return low[: alike.index(False) if False in alike else len(alike)]
