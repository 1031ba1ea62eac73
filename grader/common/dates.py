"""Read times only in the form that nbgrader writes: the text may come from students."""

import re
import time
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from pathlib import Path
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

MAX_BYTES = 200
"""How much of a file with a time is read."""
_FORM = re.compile(
    r'(?P<day>\d{4}-\d\d-\d\d)([ T](?P<clock>\d\d:\d\d(:\d\d)?)(\.(?P<fraction>\d{1,9}))?)?'
    r' ?((?P<offset>[+-]\d\d:?\d\d)|(?P<zone>[A-Za-z][A-Za-z0-9_/]{0,40}))?',
    re.ASCII,
)
_HOURS = {'WEST': 1, 'BST': 1, 'CEST': 2, 'EEST': 3, 'JST': 9, 'AEST': 10, 'AEDT': 11, 'NZDT': 13}
_HOURS |= {'EDT': -4, 'CDT': -5, 'CST': -6, 'MDT': -6, 'PDT': -7, 'PST': -8}
"""Abbreviations of zones that the time zone database lacks, with their hours from UTC. If this
machine's own zone uses one, such as CST in China, it has the meaning that it has there."""


def date_in(text: str) -> datetime | None:
    """Return the time in UTC, which is also the default zone; None if it is not a valid time."""
    found = _FORM.fullmatch(text.strip())
    if found is None:
        return None
    clock = found['clock'] or '00:00'
    fraction = (found['fraction'] or '0')[:6].ljust(6, '0')
    try:
        when = datetime.fromisoformat(f'{found["day"]} {clock}')
        zone = _zone(found['offset'] or '', found['zone'] or 'UTC')
        return when.replace(microsecond=int(fraction), tzinfo=zone).astimezone(UTC)
    except (ValueError, OverflowError, ZoneInfoNotFoundError, OSError):
        return None


def date_of(path: Path) -> datetime | None:
    """Return the time in a file; None if it has none, or if the file can't be read."""
    try:
        if not path.is_file() or path.is_symlink():
            return None
        with path.open('rb') as file:
            return date_in(file.read(MAX_BYTES).decode(errors='replace'))
    except OSError:
        return None


def utc_of(seconds: float) -> datetime | None:
    """Convert Unix time to UTC; None if it is out of range."""
    try:
        return datetime.fromtimestamp(seconds, UTC)
    except (ValueError, OverflowError, OSError):
        return None


def _zone(offset: str, name: str) -> tzinfo:
    """Return a zone. Raises ValueError, ZoneInfoNotFoundError or OSError if it is unknown."""
    if offset:
        minutes = int(offset[1:3]) * 60 + int(offset[-2:])
        return timezone(timedelta(minutes=-minutes if offset[0] == '-' else minutes))
    if name in ('UTC', 'Z', 'GMT'):
        return UTC
    for local, west_sec in zip(time.tzname, (time.timezone, time.altzone), strict=True):
        if name == local:
            return timezone(timedelta(seconds=-west_sec))
    if name in _HOURS:
        return timezone(timedelta(hours=_HOURS[name]))
    return ZoneInfo(name)
