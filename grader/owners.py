"""Whose file it is: student, assignment and time, read off where it lay and how it is named."""

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from dateutil.parser import parse
from nbgrader.utils import parse_utc

from grader.archives import ARCHIVE
from grader.incoming import TIMESTAMP, Incoming, wanted
from grader.students import Unclear, problem_of_id, student_in

EXPECTED = (
    'expected STUDENT_ASSIGNMENT.ipynb, STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb or an archive named '
    'after the student'
)
COLLECTIONS = {'notebooks', 'submitted', 'submissions', 'inbound'}
"""Folders that are named after no student."""


@dataclass(frozen=True)
class HandIn:
    """One assignment of one student, as it came in."""

    student_id: str
    assignment: str
    notebook: Incoming
    extra: dict[str, Path] = field(default_factory=dict)
    """The student's Python files beside it, by name."""
    handed_in: datetime | None = None
    """In UTC; None where nothing tells."""


@dataclass(frozen=True)
class Left:
    """A file that was not taken."""

    incoming: Incoming
    reason: str
    matters: bool = True
    """Whether a person should look at it; else nobody would grade it anyway."""


@dataclass(frozen=True)
class _Owner:
    student_id: str
    assignment: str
    by_folder: bool
    """Whether all that lies in its folder is theirs."""
    handed_in: datetime | None = None


def match(
    found: Sequence[Incoming], assignments: Iterable[str], *, file_times: bool = False
) -> tuple[list[HandIn], list[Left]]:
    """Sort what came in: submissions, each student's in their order, and the rest with reasons.

    `file_times` takes the time of a file for the time it was handed in, where nothing else tells.
    """
    names = _Names(found, assignments)
    owners: dict[Incoming, _Owner] = {}
    rest = [Left(each, each.problem) for each in found if each.problem]
    beside: dict[tuple[str, ...], dict[str, Incoming]] = defaultdict(dict)
    for each in (each for each in found if not each.problem):
        if each.parts[-1].lower().endswith('.ipynb'):
            try:
                owners[each] = names.owner(each)
            except Unclear as unclear:
                rest.append(Left(each, str(unclear)))
        elif wanted(each.parts[-1]):
            beside[each.parts[:-1]][each.parts[-1]] = each
        else:
            rest.append(Left(each, 'neither a notebook nor Python', matters=False))
    hand_ins, used = [], set()
    for notebook, owner in owners.items():
        files = beside[notebook.parts[:-1]] if owner.by_folder or notebook.archive else {}
        stamp = files.get(TIMESTAMP) if not notebook.archive else None
        when = owner.handed_in or (date_of(stamp.file) if stamp else None)
        if when is None and file_times:
            when = notebook.modified
        extra = {
            name: each.file
            for name, each in files.items()
            if name.endswith('.py') and not problem_of_id(name)
        }
        hand_ins.append(HandIn(owner.student_id, owner.assignment, notebook, extra, when))
        used |= {files[name] for name in extra}
        used |= {stamp} if stamp and date_of(stamp.file) else set()
    for each in (each for files in beside.values() for each in files.values()):
        if each not in used:
            rest.append(_not_taken(each))
    return _in_order(hand_ins, rest), rest


class _Names:
    """Reads names of files and folders."""

    def __init__(self, found: Sequence[Incoming], assignments: Iterable[str]) -> None:
        self.known = sorted(assignments, key=len, reverse=True)
        one_of = '|'.join(map(re.escape, self.known)) or '(?!)'
        self._named = re.compile(rf'(?P<who>.+?)[_+\- .]+(?P<what>{one_of})(-\d+)?')
        self._exchange = re.compile(
            rf'(?P<who>.+)\+(?P<what>{one_of})\+(?P<when>\d{{4}}-[^+]+)(\+[\w=-]+)?'
        )
        folders = [each.parts[:-1] for each in found if not each.litter]
        self._shared = len(_shared(folders))

    def owner(self, each: Incoming) -> _Owner:
        """Return whose notebook it is. Raises Unclear."""
        folders = each.parts[: each.archive] or each.parts[:-1]
        stem = re.sub(r' \(\d+\)$', '', each.parts[-1][: -len('.ipynb')])  # a browser's second one
        for folder in folders:
            if exchanged := self._exchange.fullmatch(folder):
                if stem != exchanged['what'] or each.parts[-2] != folder:
                    raise Unclear(f'in the exchange, {exchanged["what"]}.ipynb was expected here')
                when = _date(re.sub(r'(\d\d)_(\d\d)_(\d\d)', r'\1:\2:\3', exchanged['when']))
                return _Owner(student_in(exchanged['who']), stem, by_folder=True, handed_in=when)
        if stem in self.known:
            return _Owner(self._student_of(folders, stem), stem, by_folder=True)
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
            return _Owner(student, assignment, by_folder=False)
        raise Unclear(f'named after no assignment: {EXPECTED}, with {", ".join(self.known)}')

    def _student_of(self, folders: Sequence[str], assignment: str) -> str:
        """Return the student after whom the nearest folder is named."""
        for folder in reversed(folders):
            name = ARCHIVE.sub('', folder)
            if name == assignment or name in COLLECTIONS:
                continue
            if name in self.known:
                raise Unclear(f'it lies in a folder of another assignment, {name}')
            named = self._named.fullmatch(name)
            if named and named['what'] != assignment:
                raise Unclear(f'it lies in a folder of another assignment, {named["what"]}')
            return student_in(named['who'] if named else name)
        raise Unclear(f'nothing says whose it is: {EXPECTED}')

    def _other_student(self, folders: Sequence[str], student: str) -> str:
        """Return a folder that may be another student's: what they put there is named by them."""
        for folder in folders[self._shared :]:
            if folder not in (*self.known, *COLLECTIONS) and student_in(folder) != student:
                return folder
        return ''


def _shared(folders: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Return the folders in which everything lies."""
    if not folders:
        return ()
    low, high = min(folders), max(folders)
    alike = [a == b for a, b in zip(low, high, strict=False)]
    return low[: alike.index(False) if False in alike else len(alike)]


def date_of(stamp: Path) -> datetime | None:
    """Read nbgrader's timestamp.txt; None where there is no such file, or no date in it."""
    if not stamp.is_file() or stamp.is_symlink():
        return None
    with stamp.open('rb') as file:
        return _date(file.read(200).decode(errors='replace'))


def _date(text: str) -> datetime | None:
    """Read a time as nbgrader writes it; None where it is none."""
    text = text.strip()
    try:
        # nbgrader takes +0200 for 200 seconds
        offset = re.search(r'[+-]\d\d:?\d\d$', text)
        return parse(text).astimezone(UTC) if offset else parse_utc(text).replace(tzinfo=UTC)
    except (ValueError, OverflowError):
        return None


def _not_taken(each: Incoming) -> Left:
    """Say why a file that lies beside notebooks goes with none of them."""
    if each.parts[-1] != TIMESTAMP:
        return Left(each, "it lies beside no notebook, or beside several students'", matters=False)
    if each.archive:
        return Left(each, "a time in a student's own archive is not believed")
    if date_of(each.file) is None:
        return Left(each, 'it holds no date')
    return Left(each, 'it lies beside no notebook of one student')


def _in_order(hand_ins: list[HandIn], rest: list[Left]) -> list[HandIn]:
    """Sort by student, assignment and time; what can't be put in an order joins the rest."""
    whose: dict[tuple[str, str], list[HandIn]] = defaultdict(list)
    for each in hand_ins:
        whose[each.student_id, each.assignment].append(each)
    ordered = []
    for (student, assignment), several in sorted(whose.items()):
        times = {each.handed_in for each in several}
        if len(times) == len(several) and (None not in times or len(several) == 1):
            ordered += sorted(several, key=lambda each: each.handed_in or datetime.min)
            continue
        contents = {_content(each) for each in several}
        if len(contents) == 1:
            ordered.append(several[0])
            rest += [Left(each.notebook, 'the same again', matters=False) for each in several[1:]]
            continue
        others = f'one of {len(several)} notebooks for {assignment} by {student}'
        reason = f'{others}, and nothing tells which is the latest'
        rest += [Left(each.notebook, reason) for each in several]
    return ordered


def _content(each: HandIn) -> tuple[bytes, ...]:
    files = sorted(each.extra.items())
    return (each.notebook.file.read_bytes(), *(path.read_bytes() for _, path in files))
