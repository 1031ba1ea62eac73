import logging
import sys

import pytest
from psycopg import OperationalError, errors
from sqlalchemy import exc

from grader.__main__ import main
from grader.common.db_url import configured_db_url, gradebook_of, is_in_postgresql
from grader.common.errors import CourseError, GradebookError
from grader.common.logs import VisibleFilter
from grader.course import Course
from grader.storage.database import has_database, raise_gradebook_errors

URL = 'postgresql://grader:se:cr3t@db.example.org:5433/course'


@pytest.fixture
def course(tmp_path):
    course = Course.at(tmp_path)
    course.gradebook.mkdir()
    return course


def configure(course, text, mode=0o600):
    path = course.gradebook / 'database.toml'
    path.write_text(text)
    path.chmod(mode)
    return path


def test_the_database_is_one_of_sqlite_without_a_configuration_file(course):
    assert configured_db_url(course.gradebook) is None
    assert course.db_url == f'sqlite:///{course.gradebook}/gradebook.db?timeout=60'
    assert not is_in_postgresql(course.db_url)


@pytest.mark.parametrize('scheme', ['postgresql', 'postgres', 'postgresql+psycopg'])
def test_an_address_becomes_nbgraders_db_url_with_timeouts(course, scheme):
    configure(course, f'db_url = "{scheme}://grader@db/course?sslmode=verify-full"', mode=0o644)
    address, _, query = course.db_url.partition('?')
    assert address == 'postgresql+psycopg://grader@db/course'
    assert query.startswith('sslmode=verify-full&connect_timeout=10&')
    assert query.endswith('&options=-clock_timeout=60000')
    assert '%' not in course.db_url  # nbgrader writes it into a file in which that is special


def test_a_timeout_set_by_the_instructor_is_kept(course):
    configure(course, 'db_url = "postgresql:///course?host=/run/postgresql&connect_timeout=3"')
    assert course.db_url.count('connect_timeout=') == 1
    assert 'connect_timeout=3&' in course.db_url


@pytest.mark.parametrize(
    'text',
    [
        '',
        'db_url = ',
        f'db_url = "{URL}',
        'db_url = 5',
        f'url = "{URL}"',
        f'db_url = "{URL}"\nuser = "ada"',
        'db_url = "mysql://grader:se:cr3t@db/course"',
        'db_url = "postgresql://grader:se:cr3t@db"',
        'db_url = "postgresql://grader:se:cr3t@db:x/course"',
        'db_url = "postgresql:course"',
    ],
)
def test_an_invalid_address_is_reported_without_its_password(course, text, capsys):
    configure(course, text)
    assert main(['scores'], course=course) == 1
    said = capsys.readouterr().err
    assert 'database.toml has to be one line, db_url = "postgresql://USER@HOST/DATABASE"' in said
    assert 'cr3t' not in said


def test_a_password_that_others_may_read_is_refused(course):
    path = configure(course, f'db_url = "{URL}"', mode=0o640)
    with pytest.raises(CourseError, match=r'others may read the password in .*chmod 600') as told:
        _ = course.db_url
    assert 'cr3t' not in str(told.value)
    path.chmod(0o600)
    assert is_in_postgresql(course.db_url)


@pytest.mark.parametrize(
    'line',
    [f"c.CourseDirectory.db_url = '{URL}'", "c.NbGrader.db_url=os.environ['DB']"],
)
def test_an_address_in_nbgraders_configuration_is_refused(course, line, capsys):
    config = course.root / 'nbgrader_config.py'
    config.write_text(f'c.CourseDirectory.db_url = db_url\n# {line}\n')
    assert main(['due'], course=course) == 0
    config.write_text(f'c.CourseDirectory.db_url = db_url\n{line}\n')
    assert main(['due'], course=course) == 1
    said = capsys.readouterr().err
    assert 'write db_url into gradebook/database.toml' in said
    assert 'cr3t' not in said


def test_the_folder_of_a_gradebook_is_found_from_its_database_address(course, tmp_path):
    assert gradebook_of(course.db_url, tmp_path / 'elsewhere') == course.gradebook
    configure(course, f'db_url = "{URL}"')
    assert gradebook_of(course.db_url, tmp_path) == course.gradebook


def test_a_missing_psycopg_is_reported_with_the_command_that_installs_it(course, monkeypatch):
    configure(course, f'db_url = "{URL}"')
    monkeypatch.setitem(sys.modules, 'psycopg', None)
    words = r'psycopg.*pip install -r environment\.txt'
    with pytest.raises(GradebookError, match=words) as told, raise_gradebook_errors(course):
        has_database(course)
    assert 'cr3t' not in str(told.value)


FAULTS = [
    (OperationalError('connection failed: FATAL:  password authentication failed'), 'the login'),
    (OperationalError('connection failed: FATAL:  role "grader" does not exist'), 'the login'),
    (OperationalError('x failed: FATAL:  no pg_hba.conf entry for host "db"'), 'the login'),
    (OperationalError('x failed: FATAL:  database "course" does not exist'), 'createdb'),
    (OperationalError('x failed: FATAL:  sorry, too many clients already'), 'max_connections'),
    (OperationalError('x failed: FATAL:  Datenbank »course« existiert nicht'), 'existiert nicht'),
    (OperationalError('failed to resolve host: se:cr3t'), r'does not answer .*: \*\*\*'),
    (OperationalError('consuming input failed: server closed the connection'), 'does not answer'),
    (errors.AdminShutdown('terminating connection'), 'does not answer'),
    (errors.CannotConnectNow('the database system is starting up'), 'does not answer'),
    (errors.InsufficientPrivilege('permission denied for schema public'), 'OWNER TO USER'),
    (errors.ReadOnlySqlTransaction('cannot execute INSERT'), 'refuses to be written to'),
    (errors.DiskFull('could not extend file'), 'no room left'),
    (errors.TooManyConnections('too many connections'), 'max_connections'),
    (errors.LockNotAvailable('canceling statement due to lock timeout'), 'locked for too long'),
]


@pytest.mark.parametrize(('fault', 'said'), FAULTS, ids=lambda each: str(each)[:40])
def test_each_fault_of_the_database_server_is_reported_with_what_to_do(course, fault, said):
    configure(course, f'db_url = "{URL}"')
    wrapped = exc.OperationalError('SELECT 1', {}, fault)
    with pytest.raises(GradebookError, match=said) as told, raise_gradebook_errors(course):
        raise wrapped
    assert 'postgresql://grader@db.example.org:5433/course' in str(told.value)
    assert 'then run the same command again' in str(told.value)
    assert 'cr3t' not in str(told.value)


def test_a_database_error_of_the_course_s_own_code_is_passed_on_unchanged(course):
    configure(course, f'db_url = "{URL}"')
    ours = exc.DataError('INSERT', {}, errors.StringDataRightTruncation('value too long'))
    with pytest.raises(exc.DataError), raise_gradebook_errors(course):
        raise ours


def test_no_log_has_the_password():
    url = URL.replace('://', '+psycopg://')
    record = logging.LogRecord('', 20, '', 0, 'Upgrading %s, then %s', (url, 'rest@x'), None)
    assert VisibleFilter().filter(record)
    assert record.msg == (
        'Upgrading postgresql+psycopg://grader:***@db.example.org:5433/course, then rest@x'
    )
