"""Settings for a learning platform with LTI 1.3, from gradebook/lti.toml.

    issuer = "https://moodle.example.org"
    client_id = "AbC123"
    token_url = "https://moodle.example.org/mod/lti/token.php"
    lineitems = "https://moodle.example.org/mod/lti/services.php/2/lineitems?type_id=1"
    key_file = "lti_key.pem"       # our private key, beside this file
    audience = "…"                 # if the platform requires another one than the token_url
    students_are_user_ids = true   # if our student IDs are the platform's user ids

    [user_ids]                     # otherwise: the platform's id (sub) of each student
    ada = "4711"

docs/lti.md says where a platform shows each of these values.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from grader.common.errors import CourseError
from grader.course import Course

FILE = 'lti.toml'
TEXTS = ('issuer', 'client_id', 'token_url', 'lineitems', 'key_file')
OTHERS = ('audience', 'students_are_user_ids', 'user_ids')
ADDRESSES = ('token_url', 'lineitems')
LOCAL = ('localhost', '127.0.0.1', '::1')


@dataclass(frozen=True)
class LtiSettings:
    """The values that a platform gave when the course was registered with it."""

    issuer: str
    client_id: str
    token_url: str
    lineitems: str
    """The URL of this course's columns in the platform's gradebook."""
    key: str = field(repr=False)
    """Our private key, in PEM."""
    audience: str = ''
    students_are_user_ids: bool = False
    user_ids: Mapping[str, str] = field(default_factory=dict)

    def user_id_of(self, student_id: str) -> str:
        """Return the platform's id of a student, or ''."""
        return self.user_ids.get(student_id, student_id if self.students_are_user_ids else '')


def read_settings(course: Course) -> LtiSettings:
    """Read gradebook/lti.toml. Raises CourseError if something in it is wrong."""
    path = course.gradebook / FILE
    try:
        table = tomllib.loads(path.read_text(encoding='utf-8'))
    except FileNotFoundError:
        raise CourseError(
            f'there is no {path}, which says how the platform is reached: docs/lti.md shows one'
        ) from None
    except (OSError, ValueError) as error:
        raise CourseError(f'{path} cannot be read: {error}') from None
    if problem := _problem_in(table):
        raise CourseError(f'{path}: {problem} (docs/lti.md shows one that is right)')
    key = _read_key(path.parent / table.pop('key_file'))
    return LtiSettings(key=key, **table)


def _problem_in(table: dict[str, Any]) -> str:
    if unknown := sorted(table.keys() - {*TEXTS, *OTHERS}):
        return f'{unknown[0]!r} is not a name that this file can have'
    for name in (*TEXTS, 'audience'):
        value = table.get(name, '' if name == 'audience' else None)
        if not isinstance(value, str) or (name in TEXTS and not value):
            return f'{name} is missing, or is not a text in quotes'
    for name in ADDRESSES:
        address = urlsplit(table[name])
        if address.scheme != 'https' and address.hostname not in LOCAL:
            return f'{name} does not begin with https://: anyone on the way could read scores'
    if not isinstance(table.get('students_are_user_ids', False), bool):
        return 'students_are_user_ids is neither true nor false'
    ids = table.get('user_ids', {})
    if not isinstance(ids, dict) or not all(isinstance(each, str) for each in ids.values()):
        return '[user_ids] has an id that is not a text in quotes: write ada = "4711"'
    if len({*ids.values()}) < len(ids):
        return '[user_ids] gives two students the same id'
    return ''


def _read_key(path: Path) -> str:
    """Return the private key. Raises CourseError if others may read it, or if it is not a key."""
    try:
        key = path.read_text(encoding='ascii')
        mode = path.stat().st_mode & 0o777
    except (OSError, ValueError) as error:
        raise CourseError(f'the key {path} cannot be read: {error}') from None
    if mode & 0o077:
        raise CourseError(
            f'others may read the key {path} (mode {mode:o}), and could give scores with it: '
            f'chmod 600 {path}'
        )
    if 'PRIVATE KEY' not in key:
        raise CourseError(
            f'{path} is not a private key in PEM format: docs/lti.md says how to make one'
        )
    return key
