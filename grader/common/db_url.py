"""Read where nbgrader's database is, if not in a file, from gradebook/database.toml.

    db_url = "postgresql://grader@db.example.org/course"

nbgrader_config.py gives nbgrader the same db_url. The password is in ~/.pgpass, or in this
file, which other users must not be able to read then.
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
    'keepalives_idle': '30',  # seconds without data until the server is probed
    'keepalives_interval': '10',
    'keepalives_count': '3',
    'tcp_user_timeout': '60000',  # milliseconds
    'options': '-clock_timeout=60000',  # milliseconds, as SQLite's timeout
}
"""How long libpq waits. Values must not need URL encoding: nbgrader allows no `%` in the URL."""


def configured_db_url(gradebook: Path) -> str | None:
    """Return the URL in gradebook/database.toml; None if there is no such file.

    Raises CourseError if something in it is wrong.
    """
    path = gradebook / FILE
    try:
        text = path.read_text(encoding='utf-8')
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise CourseError(f'{path} cannot be read: {type(error).__name__}') from None
    try:
        table = tomllib.loads(text)
    except ValueError:  # its message may quote the password
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
    """Raise CourseError if nbgrader_config.py sets a db_url itself.

    `./course` does not read nbgrader's configuration, and would use another database.
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
    """Whether a database is in PostgreSQL, and not in a file of SQLite."""
    return db_url.startswith('postgresql')


def gradebook_of(db_url: str, root: Path) -> Path:
    """Return the gradebook of a database: the folder of SQLite's file, or else the default."""
    if is_in_postgresql(db_url):
        return root / 'gradebook'
    return Path(db_url.removeprefix('sqlite:///').split('?')[0]).parent


def _is_postgresql(url: str) -> bool:
    try:
        parts = urlsplit(url)
        _ = parts.port  # raises ValueError if it is not a valid port
    except ValueError:
        return False
    return parts.scheme in SCHEMES and len(parts.path) > 1 and '://' in url
