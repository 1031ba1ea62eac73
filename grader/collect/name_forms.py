"""Names that contain a student and an assignment: STUDENT_ASSIGNMENT, and the exchange's."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from grader.collect.archive_entries import ARCHIVE
from grader.collect.platforms import label_in

_BETWEEN = '_+- .'
"""Characters that may separate a student's name from an assignment's."""
_COPY_OF = r'(?:(?:copy of|kopie von|copie de|copia de|copia di) )+'
_COPY = re.compile(rf'^{_COPY_OF}|(?<= ){_COPY_OF}$', re.IGNORECASE)
"""What Google Drive writes before the name of a file, or of the student's own copy of it."""

_LATE = re.compile(r'^(late submission|versp(ä|ae?)tete abgabe) - ', re.IGNORECASE)
"""What ILIAS, in English and in German, writes before the name of a file that comes late."""


@dataclass(frozen=True)
class AssignmentName:
    """A name that ends with that of an assignment."""

    student: str
    assignment: str


@dataclass(frozen=True)
class ExchangeName(AssignmentName):
    """The name of a folder in nbgrader's exchange."""

    time: str


class NameForms:
    """Parses names that contain the name of one of the assignments."""

    def __init__(self, assignments: Iterable[str]) -> None:
        self._known = sorted(assignments, key=len, reverse=True)
        one_of = '|'.join(map(re.escape, self._known)) or '(?!)'
        self._exchange = re.compile(
            rf'(?P<student>.+)\+(?P<assignment>{one_of})\+(?P<time>\d{{4}}-[^+]+)(\+[\w=-]+)?'
        )

    def parse_assignment_name(self, name: str) -> AssignmentName | None:
        """Split STUDENT_ASSIGNMENT or STUDENT_ASSIGNMENT-1; None if the name has another form.

        A regular expression would take time proportional to the square of the name's length.
        """
        for whole in (name, re.sub(r'(?<=\w)-\d+$', '', name)):
            for assignment in self._known:
                student = whole.removesuffix(assignment)
                if student != whole and len(student) > 1 and student[-1] in _BETWEEN:
                    student = _COPY.sub('', student) or student
                    return AssignmentName(student.rstrip(_BETWEEN) or student[0], assignment)
        return None

    def assignment_in(self, stem: str) -> str:
        """Return the assignment that a file's name without its ending ends with, or ''."""
        named = self.parse_assignment_name(stem)
        plain = re.sub(r'-\d+$', '', stem)
        return named.assignment if named else plain if plain in self._known else ''

    def parse_exchange_name(self, name: str) -> ExchangeName | None:
        """Split STUDENT+ASSIGNMENT+TIME; None if the name has another form."""
        found = self._exchange.fullmatch(name)
        return ExchangeName(**found.groupdict()) if found else None

    def student_of(self, name: str) -> str:
        """Return the student whom the name of a folder or an archive may contain."""
        found = (
            label_in(name)
            or self.parse_exchange_name(name)
            or self.parse_assignment_name(strip_archive_ending(name))
        )
        return found.student if found else strip_archive_ending(name)


def stem_of(name: str) -> str:
    """Return a notebook's name without .ipynb, ` (1)` before it and ILIAS's mark of lateness."""
    return re.sub(r' \(\d+\)$', '', strip_late_mark(name[: -len('.ipynb')]))


def strip_late_mark(name: str) -> str:
    """Return a file's name without what ILIAS writes before it if it comes late."""
    return _LATE.sub('', name)


def strip_archive_ending(name: str) -> str:
    """Return a folder's name, or an archive's without ending, ` (1)` and mark of lateness."""
    if not ARCHIVE.search(name):
        return name
    return re.sub(r' \(\d+\)$', '', ARCHIVE.sub('', strip_late_mark(name)))


def shared_folders(folders: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Return the path of folders that all of these folders have in common."""
    if not folders:
        return ()
    low, high = min(folders), max(folders)
    alike = [a == b for a, b in zip(low, high, strict=False)]
    return low[: alike.index(False) if False in alike else len(alike)]
