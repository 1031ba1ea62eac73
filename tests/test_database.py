import errno
import os
import shutil
import sqlite3
import threading
from contextlib import closing

import psutil
import pytest
from nbgrader.api import Gradebook, InvalidEntry, Student

from grader.common.errors import CourseError, GradebookError
from grader.course import Course
from grader.storage import failures
from grader.storage.database import (
    make_database,
    open_database,
    raise_gradebook_errors,
    share_engine,
    transaction,
    wait_until_free,
)


@pytest.fixture
def course(tmp_path):
    """A course with a database that is none of nbgrader's: all databases wait and fail alike."""
    course = Course.at(tmp_path)
    course.gradebook.mkdir()
    with closing(sqlite3.connect(course.database)) as made:
        made.execute('CREATE TABLE some (thing)')
    return course


@pytest.fixture
def empty(tmp_path):
    """A course with nbgrader's database, which is empty."""
    course = Course.at(tmp_path)
    make_database(course)
    return course


@pytest.fixture
def other(course):
    """Another program, in the middle of writing."""
    connection = sqlite3.connect(course.database, isolation_level=None, check_same_thread=False)
    connection.execute('BEGIN IMMEDIATE')
    connection.execute('INSERT INTO some VALUES (1)')
    with closing(connection):
        yield connection


def open_files(path):
    return [each for each in psutil.Process().open_files() if each.path == str(path)]


def test_waiting_for_a_locked_database_is_reported(course, other):
    said = []

    def say(line):
        said.append(line)
        threading.Timer(0.3, other.execute, ['COMMIT']).start()

    wait_until_free(course, say)
    assert said == [f'waiting: another program is using {course.database}']
    wait_until_free(course, said.append)
    assert len(said) == 1


def test_a_database_that_stays_locked_is_reported_as_an_error(course, other, monkeypatch, capsys):
    monkeypatch.setattr(failures, 'TIMEOUT_SEC', 0.2)
    with (
        pytest.raises(GradebookError, match=r'locked for 0 s.*run the same command again'),
        raise_gradebook_errors(course),
    ):
        wait_until_free(course)
    assert capsys.readouterr().out.startswith('waiting: ')


@pytest.mark.parametrize('code', [errno.ENOSPC, errno.EDQUOT])
def test_a_full_disk_is_reported_even_behind_other_errors(course, code):
    wrapped = InvalidEntry('as nbgrader puts it')
    wrapped.__context__ = OSError(code, os.strerror(code))
    with (
        pytest.raises(GradebookError, match='the disk is full') as told,
        raise_gradebook_errors(course),
    ):
        raise wrapped
    assert 'run the same command again' in str(told.value)


def test_a_full_database_is_reported_as_a_full_disk(course):
    with closing(sqlite3.connect(course.database)) as full:
        full.execute('PRAGMA max_page_count = 3')
        with (
            pytest.raises(GradebookError, match='the disk is full'),
            raise_gradebook_errors(course),
        ):
            full.execute('INSERT INTO some VALUES (?)', ['x' * 100_000])


def test_a_damaged_database_is_reported_with_the_newest_backup(course):
    backups = course.gradebook / 'backups'
    backups.mkdir()
    (backups / 'gradebook-2026-01-01.db').touch()
    (backups / 'gradebook-2026-01-02.db').touch()
    course.database.write_bytes(b'not a database' * 100)
    with pytest.raises(GradebookError, match='is damaged') as told, raise_gradebook_errors(course):
        wait_until_free(course)
    assert f"cp '{backups / 'gradebook-2026-01-02.db'}' '{course.database}'" in str(told.value)


@pytest.mark.parametrize('error', [OSError(errno.EACCES, 'no'), ValueError('x'), CourseError('y')])
def test_errors_that_are_not_of_the_database_are_passed_on_unchanged(course, error):
    with pytest.raises(type(error)) as told, raise_gradebook_errors(course):
        raise error
    assert told.value is error


def test_a_database_is_made_whole_or_not_at_all(tmp_path, monkeypatch):
    course = Course.at(tmp_path)

    class Killed(BaseException):
        pass

    def killed(*_, **__):
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr('alembic.script.ScriptDirectory', killed)  # tables are made by then
        with pytest.raises(Killed):
            make_database(course)
    assert not course.database.exists()
    make_database(course)
    assert os.listdir(course.gradebook) == ['gradebook.db']
    with closing(sqlite3.connect(course.database)) as made:
        assert made.execute('SELECT count(*) FROM alembic_version').fetchone() == (1,)
    make_database(course)
    with Gradebook(course.db_url) as book:
        assert book.students == []


def test_one_engine_serves_all_connections_within_its_block(empty):
    with share_engine(empty.db_url):
        engines = set()
        for _ in range(3):
            with open_database(empty.db_url) as book:
                assert book.students == []
                engines.add(book.engine)
        assert len(engines) == 1
    with open_database(empty.db_url) as book:
        assert book.engine not in engines


def test_the_database_file_is_closed_between_two_uses_of_one_engine(empty):
    with share_engine(empty.db_url):
        with open_database(empty.db_url) as book:
            book.update_or_create_student('ada')
            book.db.add(Student(id='bob'))  # not committed
            book.db.flush()
        assert not open_files(empty.database)
        wait_until_free(empty, pytest.fail)
        with open_database(empty.db_url) as book:
            assert [student.id for student in book.students] == ['ada']


def test_writes_go_to_a_database_that_replaced_the_former_file(empty, tmp_path):
    backup = shutil.copy(empty.database, tmp_path / 'backup.db')
    with share_engine(empty.db_url):
        with transaction(empty.db_url) as book:
            book.update_or_create_student('ada')
        os.replace(backup, empty.database)
        with transaction(empty.db_url) as book:
            assert book.students == []
            book.update_or_create_student('bob')
    with Gradebook(empty.db_url) as book:
        assert [student.id for student in book.students] == ['bob']


def test_a_transaction_with_one_engine_is_all_or_nothing_and_leaves_no_trace(empty):
    def add_twice():
        with transaction(empty.db_url) as book:
            book.add_student('ada')
            book.add_student('ada')

    with share_engine(empty.db_url):
        with pytest.raises(InvalidEntry):
            add_twice()
        with open_database(empty.db_url) as book:
            assert book.students == []
            book.update_or_create_student('bob')  # nbgrader commits
        with open_database(empty.db_url) as book:
            assert [student.id for student in book.students] == ['bob']


def test_the_tables_of_a_made_database_are_those_that_nbgrader_makes(tmp_path):
    course = Course.at(tmp_path)
    make_database(course)
    Gradebook(f'sqlite:///{tmp_path / "theirs.db"}').close()

    def dumped(path):
        with closing(sqlite3.connect(path)) as database:
            tables = "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name"
            names = [name for (name,) in database.execute(tables)]
            columns = {n: database.execute(f'PRAGMA table_info({n})').fetchall() for n in names}
            version = database.execute('SELECT version_num FROM alembic_version').fetchall()
            return columns, version, database.execute('SELECT id FROM course').fetchall()

    columns, version, courses = dumped(course.database)
    theirs, their_version, their_courses = dumped(tmp_path / 'theirs.db')
    assert (version, courses) == (their_version, their_courses)
    assert set(columns) == set(theirs)
    for name, each in columns.items():
        assert [column[1] for column in each] == [column[1] for column in theirs[name]]
    assert 'grade' in columns
    assert version[0][0]
