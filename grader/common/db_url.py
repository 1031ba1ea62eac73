"""Where nbgrader's database is, if not in a file: gradebook/database.toml.

    db_url = "postgresql://grader@db.example.org/course"

nbgrader_config.py gives nbgrader the same db_url. The password is in ~/.pgpass, or in this file,
which nobody else may read then.
"""

import re
import tomllib
from pathlib import Path
from urllib.parse import urlsplit

from grader.common.errors import CourseError

FILE = 'database.toml'
SCHEMES = ('postgresql', 'postgres', 'postgresql+psycopg')
WAIT = {
    'connect_timeout': '10',  # seconds
    'keepalives_idle': '30',  # seconds until a server that says nothing is asked
    'keepalives_interval': '10',
    'keepalives_count': '3',
    'tcp_user_timeout': '60000',  # milliseconds
    'options': '-clock_timeout=60000',  # milliseconds, as SQLite's timeout
}
"""How long libpq waits. Written into the address as it is: nbgrader allows no `%` in it."""


def configured_db_url(gradebook: Path) -> str | None:
    """Return the address that gradebook/database.toml gives, or None where there is no such file.

    Raises CourseError with what is wrong in it.
    """
    path = gradebook / FILE
    try:
        text = path.read_text(encoding='utf-8')
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise CourseError(f'{path} can not be read: {type(error).__name__}') from None
    try:
        table = tomllib.loads(text)
    except ValueError:  # it quotes what may be the password
        table = {}
    url = table.get('db_url')
    if table.keys() != {'db_url'} or not isinstance(url, str) or not _is_postgresql(url):
        raise CourseError(
            f'{path} has to be one line, db_url = "postgresql://USER@HOST/DATABASE": '
            'docs/postgresql.md shows one. Without the file, the gradebook is in SQLite.'
        )
    if urlsplit(url).password and (mode := path.stat().st_mode & 0o777) & 0o077:
        raise CourseError(
            f'others may read the password in {path} (mode {mode:o}): chmod 600 {path}'
        )
    address, _, query = url.partition('?')
    given = {each.partition('=')[0] for each in query.split('&')}
    waits = [f'{name}={value}' for name, value in WAIT.items() if name not in given]
    query = '&'.join([query, *waits] if query else waits)
    return f'postgresql+psycopg://{address.partition("://")[2]}?{query}'


def refuse_another_place(config: Path) -> None:
    """Raise CourseError where nbgrader_config.py has an address of its own.

    `./course` runs no configuration of nbgrader's, and would use another database.
    """
    try:
        text = config.read_text(encoding='utf-8')
    except (OSError, ValueError):
        return
    if re.search(r'^\s*c\.\w+\.db_url\s*=(?!\s*db_url\b)', text, re.MULTILINE):
        raise CourseError(
            f'{config} sets db_url itself, and ./course would not use that: write db_url into '
            f'gradebook/{FILE}, which both read (docs/postgresql.md)'
        )


def is_in_postgresql(db_url: str) -> bool:
    """Whether a database is in PostgreSQL, and not a file of SQLite's."""
    return db_url.startswith('postgresql')


def gradebook_of(db_url: str, root: Path) -> Path:
    """Return the gradebook that a database belongs to: SQLite's lies in it."""
    if is_in_postgresql(db_url):
        return root / 'gradebook'
    return Path(db_url.removeprefix('sqlite:///').split('?')[0]).parent


def _is_postgresql(url: str) -> bool:
    try:
        parts = urlsplit(url)
        _ = parts.port  # raises ValueError where it is none
    except ValueError:
        return False
    return parts.scheme in SCHEMES and len(parts.path) > 1 and '://' in url
