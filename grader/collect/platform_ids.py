"""The numbers that course platforms give students: kept for the files that go back to them.

gradebook/numbers.json contains {student: {assignment: {'moodle': '8001'}}}. A student has one
number in Canvas, but another one for each assignment in Moodle.
"""

import json
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

from grader.collect.matching import MatchedFile
from grader.collect.platforms import PlatformLabel
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course

FILE = 'numbers.json'


class StudentNumbers:
    """The students' numbers that are known; hold the gradebook's lock to change one."""

    def __init__(self, course: Course) -> None:
        """Read the file of numbers. Raises CourseError if it is damaged."""
        self._path = course.gradebook / FILE
        self._kept: dict[str, dict[str, dict[str, str]]] = {}
        if self._path.exists():
            try:
                self._kept = _checked(json.loads(self._path.read_text(encoding='utf-8')))
            except (ValueError, RecursionError):
                raise CourseError(
                    f'{self._path} is damaged: restore it from a backup, or remove it. If you '
                    'remove it, students of the same name in earlier downloads can be confused.'
                ) from None

    def of(self, student_id: str, assignment: str) -> dict[str, str]:
        """Return a student's numbers in an assignment, by platform."""
        return self._kept.get(student_id, {}).get(assignment, {})

    def check_and_store(self, hand_ins: Sequence[MatchedFile]) -> list[str]:
        """Store the students' numbers; return for each submission why it is not taken, or ''.

        It is not taken if students of the same name have several numbers: a submission must never
        replace that of another student with the same name.
        """
        came = defaultdict(set)
        for each in hand_ins:
            if label := _label_with_number(each):
                came[_number_key(each)].add(label.number)
        problems = [
            _problem(each, came[_number_key(each)] | self._known(each)) for each in hand_ins
        ]
        changed = False
        for each, problem in zip(hand_ins, problems, strict=True):
            if (label := _label_with_number(each)) and not problem:
                theirs = self._kept.setdefault(each.student_id, {}).setdefault(each.assignment, {})
                changed |= theirs.get(label.platform.name) != label.number
                theirs[label.platform.name] = label.number
        if changed:
            text = json.dumps(self._kept, ensure_ascii=False, indent=1, sort_keys=True)
            write_whole(self._path, text + '\n')
        return problems

    def _known(self, each: MatchedFile) -> set[str]:
        """Return the numbers that a student of that name had before."""
        if (label := _label_with_number(each)) is None:
            return set()
        platform, theirs = label.platform, self._kept.get(each.student_id, {})
        if platform.number_of == 'assignment':
            theirs = {each.assignment: self.of(each.student_id, each.assignment)}
        return {numbers[platform.name] for numbers in theirs.values() if platform.name in numbers}


def _label_with_number(each: MatchedFile) -> PlatformLabel | None:
    """Return the submission's platform label if it has a number that is kept; else None."""
    return each.label if each.label and each.label.platform.number_of != 'download' else None


def _number_key(each: MatchedFile) -> tuple[str, ...]:
    """Return a key; submissions with the same key are expected to have the same number."""
    if (label := _label_with_number(each)) is None:
        return ()
    of = each.assignment if label.platform.number_of == 'assignment' else ''
    return label.platform.name, each.student_id, of


def _problem(each: MatchedFile, numbers: set[str]) -> str:
    label = _label_with_number(each)
    if label is None or numbers == {label.number}:
        return ''
    platform, who = label.platform.title, each.student_id
    others = ', '.join(sorted(numbers - {label.number}))
    return (
        f"the name {who} has {platform}'s number {label.number} here and {others} elsewhere: "
        f'if it is one person, rename the folder to {who}, without the number; if not, give each '
        'folder a name of its own'
    )


def _checked(kept: Any) -> dict[str, dict[str, dict[str, str]]]:
    """Return what was read. Raises ValueError if it has another form."""
    fits = isinstance(kept, dict) and all(
        isinstance(numbers, dict) and all(isinstance(n, str) for n in numbers.values())
        for of_student in kept.values()
        for numbers in (of_student.values() if isinstance(of_student, dict) else [None])
    )
    if not fits:
        raise ValueError('it does not map students to assignments and numbers')
    return kept
