"""Backups of a PostgreSQL database, made by pg_dump before each run."""

import hashlib
import os
import subprocess
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import create_engine, make_url

from grader.storage.postgresql import state_of

PROGRAM = 'pg_dump'
_TIMEOUT_SEC = 600.0


def dump(db_url: str, folder: Path, kept: int, say: Callable[[str], None]) -> Path | None:
    """Dump the database into a folder, unless the newest dump is the same; return the newest.

    If pg_dump can't do it, return None and `say` why: grading does not need it.
    """
    folder.mkdir(exist_ok=True)
    state = hashlib.sha256(state_of(db_url).encode()).hexdigest()[:12]
    dumps = sorted(folder.glob('gradebook-*.dump'))
    if dumps and dumps[-1].stem.endswith(f'-{state}'):
        return dumps[-1]
    aside = folder / '.new.dump'
    try:
        if problem := _dump(db_url, aside):
            say(f'No backup of the database is made: {problem}')
            return None
        made = folder / f'gradebook-{datetime.now(UTC):%Y-%m-%dT%H-%M-%S.%fZ}-{state}.dump'
        os.replace(aside, made)
    finally:
        aside.unlink(missing_ok=True)
    for old in [*dumps, made][:-kept]:
        old.unlink()
    return made


def _dump(db_url: str, file: Path) -> str:
    """Write a dump; return why that can't be done, or ''. No argument contains the password."""
    from psycopg.conninfo import make_conninfo

    url = make_url(db_url)
    _, given = create_engine(url).dialect.create_connect_args(url)
    password = given.pop('password', None)
    given.pop('context', None)  # for psycopg only
    environment = {**os.environ, **({'PGPASSWORD': str(password)} if password else {})}
    command = [PROGRAM, '--format=custom', f'--file={file}', '--no-password']
    try:
        done = subprocess.run(
            [*command, f'--dbname={make_conninfo(**given)}'],
            env=environment,
            capture_output=True,
            text=True,
            errors='replace',
            check=False,
            timeout=_TIMEOUT_SEC,
        )
    except FileNotFoundError:
        return (
            f'there is no {PROGRAM} here (sudo apt install postgresql-client). '
            "Back it up as your server's administrator does."
        )
    except subprocess.TimeoutExpired:
        return f'{PROGRAM} has not ended within {_TIMEOUT_SEC:.0f} s.'
    if done.returncode == 0:
        return ''
    said = ' '.join(done.stderr.split()) or f'status {done.returncode}'
    return f'{said.replace(str(password), "***") if password else said}.'
