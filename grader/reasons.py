"""Why points are missing, or a person is asked for: what is the same but for numbers is one."""

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from grader.text import printable

NUMBER = re.compile(r'(?<!\w)[-+]?\d+(\.\d+)?(e[-+]?\d+)?(?!\w)')
_MANY = re.compile(r'…(, …)+')


@dataclass(frozen=True)
class Said:
    """What was said of one graded cell of one student, or of all that was handed in."""

    student_id: str
    assignment: str
    grade_id: str
    """'' where it is about all of it."""
    text: str


@dataclass(frozen=True)
class Reason:
    """What was said of several students, where it is the same but for numbers."""

    assignment: str
    words: str
    """What was said, with … for its numbers where those differ."""
    example: str
    students: tuple[str, ...]
    checks: tuple[str, ...]


def grouped(all_said: Iterable[Said]) -> list[Reason]:
    """Group what was said by its words; the most common comes first. All of it is printable."""
    found = defaultdict(list)
    for said in all_said:
        text = printable(said.text)
        found[printable(said.assignment), numberless(text)].append((said, text))
    reasons = [
        Reason(
            assignment=assignment,
            words=alike[0][1] if len({text for _, text in alike}) == 1 else words,
            example=alike[0][1],
            students=tuple(dict.fromkeys(printable(said.student_id) for said, _ in alike)),
            checks=tuple(dict.fromkeys(said.grade_id for said, _ in alike if said.grade_id)),
        )
        for (assignment, words), alike in found.items()
    ]
    return sorted(reasons, key=lambda each: (-len(each.students), each.assignment, each.words))


def numberless(reason: str) -> str:
    """Return a reason with … in the place of its numbers, and of lists of them."""
    return _MANY.sub('…', NUMBER.sub('…', reason))
