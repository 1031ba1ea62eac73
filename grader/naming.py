"""What names of files and folders tell of a notebook: its student, its assignment and its time."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from dateutil.parser import parse
from nbgrader.utils import parse_utc

from grader.entries import ARCHIVE
from grader.incoming import Incoming
from grader.students import Unclear, student_in

EXPECTED = (
    'expected STUDENT_ASSIGNMENT.ipynb, STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb or an archive named '
    'after the student'
)
COLLECTIONS = {'notebooks', 'submitted', 'submissions', 'inbound'}
"""Folders that are named after no student."""


@dataclass(frozen=True)
class Owner:
    """Whose a notebook is, as far as names tell."""

    student_id: str
    assignment: str
    by_folder: bool
    """Whether all that lies in its folder is theirs."""
    handed_in: datetime | None = None
    """In UTC; None where its name tells no time."""


class Naming:
    """How the files and folders of what came in are named."""

    def __init__(self, found: Sequence[Incoming], assignments: Iterable[str]) -> None:
        self._known = sorted(assignments, key=len, reverse=True)
        one_of = '|'.join(map(re.escape, self._known)) or '(?!)'
        self._named = re.compile(rf'(?P<who>.+?)[_+\- .]+(?P<what>{one_of})(-\d+)?')
        self._exchange = re.compile(
            rf'(?P<who>.+)\+(?P<what>{one_of})\+(?P<when>\d{{4}}-[^+]+)(\+[\w=-]+)?'
        )
        folders = [each.parts[:-1] for each in found if not each.litter]
        self._shared = len(_shared(folders))

    def owner(self, each: Incoming) -> Owner:
        """Return whose notebook it is. Raises Unclear."""
        folders = each.parts[: each.archive] or each.parts[:-1]
        stem = re.sub(r' \(\d+\)$', '', each.parts[-1][: -len('.ipynb')])  # a browser's second one
        for folder in folders:
            if exchanged := self._exchange.fullmatch(folder):
                if stem != exchanged['what'] or each.parts[-2] != folder:
                    raise Unclear(f'in the exchange, {exchanged["what"]}.ipynb was expected here')
                when = date_in(re.sub(r'(\d\d)_(\d\d)_(\d\d)', r'\1:\2:\3', exchanged['when']))
                return Owner(student_in(exchanged['who']), stem, by_folder=True, handed_in=when)
        if stem in self._known:
            return Owner(self._student_of(folders, stem), stem, by_folder=True)
        if named := self._named.fullmatch(stem):
            student, assignment = student_in(named['who']), named['what']
            if each.archive:
                holder = self._student_of(folders, assignment)
                if student != holder:
                    raise Unclear(f'it is named after {student}, and in the archive of {holder}')
            elif strange := self._other_student(folders, student):
                raise Unclear(
                    f'it is named after {student}, and in a folder {strange}: collect that '
                    'folder by itself, or rename it'
                )
            return Owner(student, assignment, by_folder=False)
        known = ', '.join(sorted(self._known))
        raise Unclear(f'named after no assignment: {EXPECTED}, with {known}')

    def _student_of(self, folders: Sequence[str], assignment: str) -> str:
        """Return the student after whom the nearest folder is named."""
        for folder in reversed(folders):
            name = ARCHIVE.sub('', folder)
            if name == assignment or name in COLLECTIONS:
                continue
            if name in self._known:
                raise Unclear(f'it lies in a folder of another assignment, {name}')
            named = self._named.fullmatch(name)
            if named and named['what'] != assignment:
                raise Unclear(f'it lies in a folder of another assignment, {named["what"]}')
            return student_in(named['who'] if named else name)
        raise Unclear(f'nothing says whose it is: {EXPECTED}')

    def _other_student(self, folders: Sequence[str], student: str) -> str:
        """Return a folder that may be another student's: what they put there is named by them."""
        for folder in folders[self._shared :]:
            if folder not in (*self._known, *COLLECTIONS) and student_in(folder) != student:
                return folder
        return ''


def _shared(folders: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Return the folders in which everything lies."""
    if not folders:
        return ()
    low, high = min(folders), max(folders)
    alike = [a == b for a, b in zip(low, high, strict=False)]
    return low[: alike.index(False) if False in alike else len(alike)]


def date_in(text: str) -> datetime | None:
    """Read a time as nbgrader writes it; None where it is none."""
    text = text.strip()
    try:
        # nbgrader takes +0200 for 200 seconds
        offset = re.search(r'[+-]\d\d:?\d\d$', text)
        return parse(text).astimezone(UTC) if offset else parse_utc(text).replace(tzinfo=UTC)
    except (ValueError, OverflowError):
        return None
