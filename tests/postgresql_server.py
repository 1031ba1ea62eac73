"""A PostgreSQL server in a temporary folder, run by an unprivileged user, for tests.

Its programs come from Debian's package postgresql.
"""

import itertools
import os
import pwd
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psycopg
import pytest
from course_maker import released_course
from psycopg import sql

from grader.course import Course
from grader.storage.database import transaction

PASSWORD = 'a-Pass_w0rd-that-no-line-may-have'
USER = 'grader'


def programs() -> Path:
    """Return the folder of the newest server's programs; skip the test if there is none."""
    on_path = shutil.which('initdb')
    found = [Path(on_path).parent] if on_path else []
    found += sorted(Path('/usr/lib/postgresql').glob('*/bin'), key=lambda p: int(p.parent.name))
    if not found:
        pytest.skip('there is no server of PostgreSQL: sudo apt install postgresql')
    return found[-1]


class Server:
    """A server that can be stopped, killed and started again, with a user who owns databases."""

    def __init__(self) -> None:
        """Make a database cluster in a new folder, and start it."""
        self.programs = programs()
        self.numbers = itertools.count()
        self.folder = Path(tempfile.mkdtemp(prefix='postgresql-', dir='/tmp'))
        self.who = {}
        if os.geteuid() == 0:  # PostgreSQL refuses to run as root
            nobody = pwd.getpwnam('nobody')
            self.who = {'user': nobody.pw_uid, 'group': nobody.pw_gid, 'extra_groups': []}
            os.chown(self.folder, nobody.pw_uid, nobody.pw_gid)
        with socket.create_server(('127.0.0.1', 0)) as free:
            self.port = free.getsockname()[1]
        words = self.folder / 'password'
        words.write_text(PASSWORD)
        words.chmod(0o644)
        self.run(
            *('initdb', '--username=administrator', '--auth=scram-sha-256', '--no-sync'),
            *(f'--pwfile={words}', '--encoding=UTF8', '--locale=C.UTF-8', '-D', self.data),
        )
        self.start()
        with self.administrator() as connection:
            connection.execute(
                sql.SQL('CREATE ROLE {} LOGIN PASSWORD {}').format(sql.Identifier(USER), PASSWORD)
            )

    @property
    def data(self) -> str:
        return str(self.folder / 'data')

    def run(self, program: str, *arguments: str) -> None:
        done = subprocess.run(
            [self.programs / program, *arguments],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,  # the server would inherit a pipe and keep it open
            stderr=subprocess.DEVNULL,
            env={'PATH': os.environ['PATH'], 'LC_ALL': 'C.UTF-8'},
            check=False,
            **self.who,
        )
        assert done.returncode == 0, self.log()

    def start(self) -> None:
        options = f'-p {self.port} -c listen_addresses=127.0.0.1 -c fsync=off'
        options += f' -c unix_socket_directories={self.folder}'
        log = str(self.folder / 'log')
        self.run('pg_ctl', 'start', '-w', '-t', '120', '-D', self.data, '-l', log, '-o', options)

    def stop(self, how: str = 'immediate') -> None:
        """Stop it: 'immediate' is a crash, 'fast' ends connections, 'smart' waits for them."""
        self.run('pg_ctl', 'stop', '-w', '-t', '120', '-D', self.data, '-m', how)

    def end(self) -> None:
        if Path(self.data, 'postmaster.pid').exists():
            self.stop()
        shutil.rmtree(self.folder)

    def log(self) -> str:
        log = self.folder / 'log'
        return log.read_text(errors='replace') if log.exists() else ''

    def administrator(self, database: str = 'postgres') -> psycopg.Connection:
        return psycopg.connect(
            host='127.0.0.1',
            port=self.port,
            user='administrator',
            password=PASSWORD,
            dbname=database,
            autocommit=True,
        )

    def fresh(self) -> str:
        """Make an empty database with a new name; return its URL."""
        return self.make(f'course_{next(self.numbers)}')

    def make(self, database: str, owner: str = USER, encoding: str = 'UTF8') -> str:
        """Make a database; return its URL, with the password."""
        with self.administrator() as connection:
            connection.execute(
                sql.SQL(
                    'CREATE DATABASE {} OWNER {} ENCODING {} LOCALE {} TEMPLATE template0'
                ).format(sql.Identifier(database), sql.Identifier(owner), encoding, 'C')
            )
        return self.address(database)

    def address(self, database: str, password: str = PASSWORD) -> str:
        return f'postgresql://{USER}:{password}@127.0.0.1:{self.port}/{database}'


@contextmanager
def running() -> Iterator[Server]:
    """Yield a server, which is removed at the end."""
    server = Server()
    try:
        yield server
    finally:
        server.end()


def released_in(server: Server, root: Path) -> Course:
    """Return a course with one released lesson, whose empty gradebook is in PostgreSQL."""
    course = released_course(root)
    course.database.unlink()
    use(course.gradebook, server.fresh())
    return course


def students_in(course: Course) -> list[str]:
    """Return the students in the database, sorted."""
    with transaction(course.db_url) as book:
        return sorted(student.id for student in book.students)


def nbgrader(course: Course, *arguments: str) -> subprocess.CompletedProcess:
    """Run a command of nbgrader itself in the course's folder."""
    return subprocess.run(
        [sys.executable, '-P', '-m', 'nbgrader', *arguments],
        cwd=course.root,
        capture_output=True,
        text=True,
        check=False,
    )


def use(gradebook: Path, url: str) -> None:
    """Configure a gradebook to be in PostgreSQL, as an instructor does."""
    gradebook.mkdir(parents=True, exist_ok=True)
    path = gradebook / 'database.toml'
    path.touch(mode=0o600)
    path.write_text(f'db_url = "{url}"\n')
