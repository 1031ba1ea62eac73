"""Group reasons for missing points and for manual work: those that differ only in numbers."""

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from grader.common.text import printable

NUMBER = re.compile(r'(?<!\w)[-+]?\d+(\.\d+)?(e[-+]?\d+)?(?!\w)')
_MANY = re.compile(r'…(, …)+')


@dataclass(frozen=True)
class CellMessage:
    """The message about one graded cell of one student, or about a whole submission."""

    student_id: str
    assignment: str
    grade_id: str
    """'' for a whole submission."""
    text: str


@dataclass(frozen=True)
class Reason:
    """A message to several students, in which only the numbers differ."""

    assignment: str
    words: str
    """The message, with … for numbers that differ."""
    example: str
    students: tuple[str, ...]
    checks: tuple[str, ...]


def group_messages(all_said: Iterable[CellMessage]) -> list[Reason]:
    """Group messages by their words; the most common comes first. All text is made printable."""
    found = defaultdict(list)
    for said in all_said:
        text = printable(said.text)
        found[printable(said.assignment), without_numbers(text)].append((said, text))
    reasons = [
        Reason(
            assignment=assignment,
            words=_common([text for _, text in alike]),
            example=alike[0][1],
            students=tuple(dict.fromkeys(printable(said.student_id) for said, _ in alike)),
            checks=tuple(dict.fromkeys(said.grade_id for said, _ in alike if said.grade_id)),
        )
        for (assignment, _), alike in found.items()
    ]
    return sorted(reasons, key=lambda each: (-len(each.students), each.assignment, each.words))


def without_numbers(reason: str) -> str:
    """Return a message with … in place of its numbers, and of lists of numbers."""
    return _MANY.sub('…', NUMBER.sub('…', reason))


def _common(reasons: list[str]) -> str:
    """Return the words of messages that differ only in numbers, with … for numbers that differ."""
    numbers = [[found[0] for found in NUMBER.finditer(reason)] for reason in reasons]
    if len(set(map(len, numbers))) > 1:  # they contain lists of numbers, of different lengths
        return without_numbers(reasons[0])
    same = iter([len(set(each)) == 1 for each in zip(*numbers, strict=True)])
    return _MANY.sub('…', NUMBER.sub(lambda found: found[0] if next(same) else '…', reasons[0]))
