"""Why points are missing, or a person is needed: messages that differ only in numbers are one."""

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from grader.common.text import printable

NUMBER = re.compile(r'(?<!\w)[-+]?\d+(\.\d+)?(e[-+]?\d+)?(?!\w)')
_MANY = re.compile(r'…(, …)+')


@dataclass(frozen=True)
class CellMessage:
    """What was said of one graded cell of one student, or of all that was handed in."""

    student_id: str
    assignment: str
    grade_id: str
    """'' where it is about all of it."""
    text: str


@dataclass(frozen=True)
class Reason:
    """What was said of several students, where only the numbers differ."""

    assignment: str
    words: str
    """What was said, with … for its numbers where those differ."""
    example: str
    students: tuple[str, ...]
    checks: tuple[str, ...]


def grouped(all_said: Iterable[CellMessage]) -> list[Reason]:
    """Group what was said by its words; the most common comes first. All of it is printable."""
    found = defaultdict(list)
    for said in all_said:
        text = printable(said.text)
        found[printable(said.assignment), numberless(text)].append((said, text))
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


def numberless(reason: str) -> str:
    """Return a reason with … in the place of its numbers, and of lists of them."""
    return _MANY.sub('…', NUMBER.sub('…', reason))


def _common(reasons: list[str]) -> str:
    """Return the words of reasons that differ only in numbers, with … for those that differ."""
    numbers = [[found[0] for found in NUMBER.finditer(reason)] for reason in reasons]
    if len(set(map(len, numbers))) > 1:  # lists of numbers, of different lengths
        return numberless(reasons[0])
    same = iter([len(set(each)) == 1 for each in zip(*numbers, strict=True)])
    return _MANY.sub('…', NUMBER.sub(lambda found: found[0] if next(same) else '…', reasons[0]))
