"""Course platforms: what each one writes around the names of students and of their files."""

import re
import unicodedata
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Literal

from grader.common.student_names import UnclearOwner, is_nobody, problem_of_id


@dataclass(frozen=True, kw_only=True)
class Platform:
    """A course platform, as its downloads name students."""

    name: str
    """As gradebook/numbers.json has it: 'moodle'."""
    form: re.Pattern[str]
    """What it writes before the name of a file, or as a folder's name. Its groups are `who`,
    `number`, `rest` (what the student called the file; none in a folder's name), perhaps `time`.
    """
    number_of: Literal['student', 'assignment', 'download']
    """Whether a student has one number, or another one in each assignment; 'download' is one that
    only tells equal names in a download apart, and is not kept."""
    time_format: str = ''
    """Of the group `time`, the wall clock's when it was handed in."""
    numbers_copies: bool = False
    """Whether it puts -1, -2, … behind the name of a file that is handed in again."""
    is_plain: bool = False
    """Whether one student's upload can be collected by itself: nothing else has such a name."""
    names_files_only: bool = False
    """Whether it names no folder: one of its form is an upload that somebody unpacked, or a
    teacher's, whose class is called so."""


# The part before `rest` ends as early as it can: what follows it was the student's choice.
PLATFORMS = (
    Platform(
        name='moodle',
        form=re.compile(
            r'(?P<who>.+?)_(?P<number>\d+)_assignsubmission_(file|onlinetext)_?(?P<rest>.*)'
        ),
        number_of='assignment',
        is_plain=True,
    ),
    Platform(
        name='canvas',
        form=re.compile(
            r'(?P<who>[^_]+)(_LATE)?_(?P<number>\d{3,})_(?P<upload>\d{3,})_(?P<rest>.+)', re.I
        ),
        number_of='student',
        numbers_copies=True,
        names_files_only=True,
    ),
    # it has no numbers: what stands before the time tells a_lovelace and b_lovelace apart
    Platform(
        name='blackboard',
        form=re.compile(
            r'(?P<number>.+?_(?P<who>[^_]+))_attempt_(?P<time>\d{4}(-\d\d){5})(_(?P<rest>.*))?'
        ),
        number_of='download',
        time_format='%Y-%m-%d-%H-%M-%S',
        is_plain=True,
    ),
)
_ANONYMOUS = {'Participant', 'Teilnehmer', 'Teilnehmerin'}
"""What Moodle calls everybody where teachers must not know who it was."""


@dataclass(frozen=True)
class PlatformLabel:
    """What a course platform wrote before the name of a file, or as a folder's name."""

    platform: Platform
    number: str
    who: str
    rest: str
    """What the student called the file; '' in a folder's name."""
    handed_in: datetime | None = None
    """In UTC; None where it tells no time."""


def label_in(name: str) -> PlatformLabel | None:
    """Return what a course platform says in a name, if one of them wrote it.

    Where several may have, what a student called a file looks like another one's: the name that
    stands first was not theirs to choose.
    """
    found = [
        (match.end('who'), place, match)
        for place, platform in enumerate(PLATFORMS)
        if (match := platform.form.fullmatch(name))
        and not (platform.names_files_only and _is_class(match))
    ]
    if not found:
        return None
    _, place, match = min(found, key=lambda each: each[:2])
    platform, who, number = PLATFORMS[place], match['who'], match['number']
    who = f'{who} {number}' if who in _ANONYMOUS else who
    return PlatformLabel(platform, number, who, match['rest'] or '', _time(platform, match))


def student_in(name: str) -> str:
    """Return the student's name in a name. Raises UnclearOwner."""
    name = unicodedata.normalize('NFC', name)
    if label := label_in(name):
        name = label.who
    name = name.strip(' ')
    if is_nobody(name):
        raise UnclearOwner(f'{name!r} names work or a class: rename it after a student')
    if problem := problem_of_id(name):
        raise UnclearOwner(problem)
    return name


def _is_class(found: re.Match[str]) -> bool:
    """Whether a class is called so: ws_2026_2027_a, with a year and the next, or kurs_101_202_a.

    Names with words for work or a class are nobody's.
    """
    number, other = found['number'], found.groupdict().get('upload', '')
    of_years = len(number) == len(other) == 4 and int(other) - int(number) in (0, 1)
    return of_years or is_nobody(found['who'])


def _time(platform: Platform, found: re.Match[str]) -> datetime | None:
    """Return when it was handed in; the platform's time zone is taken to be this machine's."""
    if not platform.time_format:
        return None
    try:
        return datetime.strptime(found['time'], platform.time_format).astimezone(UTC)
    except (ValueError, OverflowError, OSError):
        return None
