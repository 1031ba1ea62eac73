"""Course platforms: what each of them adds to the names of students and of their files."""

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Literal

from grader.common.student_names import UnclearOwner, is_nobody, problem_of_id


@dataclass(frozen=True, kw_only=True)
class Platform:
    """A course platform, and how its downloads name students."""

    name: str
    """Its key in gradebook/numbers.json: 'moodle'."""
    form: re.Pattern[str]
    """What it writes before the name of a file, or as a folder's name. Its groups are `student`,
    `number`, `rest` (what the student called the file; none in a folder's name), perhaps `time`
    and `late` (its mark of a late submission).
    """
    number_of: Literal['student', 'assignment', 'download']
    """Whether a student has one number, or one for each assignment; 'download': the number only
    tells equal names in one download apart, and is not kept."""
    time_format: str = ''
    """The format of the group `time`, the local time when it was handed in."""
    numbers_copies: bool = False
    """Whether it appends -1, -2, … to the name of a file that is handed in again."""
    is_plain: bool = False
    """Whether an upload can be collected by itself: nothing else has a name of this form."""
    may_be_class: bool = False
    """Whether an instructor's folder may happen to have a name of its form, that of a class."""
    marks_late_files: bool = False
    """Whether it marks a file in such a folder that is handed in late."""

    @property
    def title(self) -> str:
        """What people call it."""
        return 'ILIAS' if self.name == 'ilias' else self.name.capitalize()


# Each form matches as little as possible before `rest`, which the student chose.
PLATFORMS = (
    Platform(
        name='moodle',
        form=re.compile(
            r'(?P<student>.+?)_(?P<number>\d+)_assignsubmission_(file|onlinetext)_?(?P<rest>.*)'
        ),
        number_of='assignment',
        is_plain=True,
    ),
    Platform(
        name='canvas',
        form=re.compile(
            r'(?P<student>[^_]+)(?P<late>_LATE)?_(?P<number>\d{3,})_(?P<upload>\d{3,})_(?P<rest>.+)',
            re.I,
        ),
        number_of='student',
        numbers_copies=True,
        may_be_class=True,  # it gives no folder a name: such a folder may be an unpacked upload
    ),
    # Blackboard has no numbers: the text before the time tells a_lovelace and b_lovelace apart
    Platform(
        name='blackboard',
        form=re.compile(
            r'(?P<number>.+?_(?P<student>[^_]+))_attempt_(?P<time>\d{4}(-\d\d){5})(_(?P<rest>.*))?'
        ),
        number_of='download',
        time_format='%Y-%m-%d-%H-%M-%S',
        is_plain=True,
    ),
    # ILIAS names only folders, LASTNAME_FIRSTNAME_LOGIN_NUMBER, without a time; a class's folder
    # has no number with three digits that is not a year, after a word with a letter
    Platform(
        name='ilias',
        form=re.compile(
            r'(?P<student>[^_]+_[^_]+)_[^_]*[^\W\d_][^_]*_(?!(19|20)\d\d$)(?P<number>\d{3,})(?P<rest>)'
        ),
        number_of='student',
        may_be_class=True,
        marks_late_files=True,
    ),
)
_ANONYMOUS = {'Participant', 'Teilnehmer', 'Teilnehmerin'}
"""Names that Moodle gives to all students if the assignment is graded anonymously."""


@dataclass(frozen=True)
class PlatformLabel:
    """What a course platform wrote before the name of a file, or as a folder's name."""

    platform: Platform
    number: str
    student: str
    rest: str
    """The student's name for the file; '' in a folder's name."""
    handed_in: datetime | None = None
    """In UTC; None if the name contains no time."""
    is_late: bool = False
    """Whether the platform has marked the submission as late in this name."""


def label_in(name: str) -> PlatformLabel | None:
    """Return what a course platform wrote into a name, or None.

    If a name has the form of several platforms, the student imitated one in the file's name: the
    platform whose student name ends first wrote the beginning, which the student can't choose.
    """
    found = [
        (match.end('student'), place, match)
        for place, platform in enumerate(PLATFORMS)
        if (match := platform.form.fullmatch(name))
        and not (platform.may_be_class and _is_class(match))
    ]
    if not found:
        return None
    _, place, match = min(found, key=lambda each: each[:2])
    platform, student, number = PLATFORMS[place], match['student'], match['number']
    student = f'{student} {number}' if student in _ANONYMOUS else student
    return PlatformLabel(
        platform,
        number,
        student,
        match['rest'] or '',
        _time(platform, match),
        is_late=bool(match.groupdict().get('late')),
    )


def student_in(name: str) -> str:
    """Return the student's name that a name contains. Raises UnclearOwner."""
    name = unicodedata.normalize('NFC', name)
    if label := label_in(name):
        name = label.student
    name = name.strip(' ')
    if is_nobody(name):
        raise UnclearOwner(f'{name!r} names work or a class: rename it after a student')
    if problem := problem_of_id(name):
        raise UnclearOwner(problem)
    return name


def _is_class(found: re.Match[str]) -> bool:
    """Whether it is the name of a class: ws_2026_2027_a, with a year and the next, kurs_101_202_a.

    A name with a word for work or for a class is not a student's.
    """
    number, other = found['number'], found.groupdict().get('upload', '')
    of_years = len(number) == len(other) == 4 and int(other) - int(number) in (0, 1)
    return of_years or is_nobody(found['student'])


def owner_in(parts: Sequence[str]) -> tuple[str, ...]:
    """Return what all paths of files have in common that a platform names after one student.

    () if no platform does, or if a folder may be that of a class.
    """
    last = len(parts) - 1
    for at, part in enumerate(parts):
        if (label := label_in(part)) and (at == last or not label.platform.may_be_class):
            return *parts[:at], label.platform.name, label.student, label.number
    return ()


def _time(platform: Platform, found: re.Match[str]) -> datetime | None:
    """Return when it was handed in; the platform's time is taken as this machine's local time."""
    if not platform.time_format:
        return None
    try:
        return datetime.strptime(found['time'], platform.time_format).astimezone(UTC)
    except (ValueError, OverflowError, OSError):
        return None
