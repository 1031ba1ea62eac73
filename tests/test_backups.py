import shutil
import sqlite3
from contextlib import closing

import pytest

from grader.common.errors import GradebookError
from grader.course import Course
from grader.storage.backups import KEPT, back_up, recover_and_back_up


@pytest.fixture
def course(tmp_path):
    course = Course.at(tmp_path)
    course.gradebook.mkdir()
    return course


def write(course, number):
    with closing(sqlite3.connect(course.database)) as database:
        database.execute('CREATE TABLE IF NOT EXISTS some (thing)')
        database.execute('INSERT INTO some VALUES (?)', [number])
        database.commit()


def things(path):
    with closing(sqlite3.connect(path)) as database:
        return [thing for (thing,) in database.execute('SELECT thing FROM some')]


def backups(course):
    return sorted((course.gradebook / 'backups').iterdir())


def test_no_backup_is_made_without_a_database(course):
    assert back_up(course) is None
    recover_and_back_up(course)
    assert not list(course.gradebook.iterdir())


def test_an_unchanged_database_is_not_backed_up_again(course):
    write(course, 1)
    first = back_up(course)
    assert back_up(course) == first
    write(course, 2)
    second = back_up(course)
    assert backups(course) == [first, second]
    assert [things(path) for path in backups(course)] == [[1], [1, 2]]


def test_only_the_newest_backups_are_kept(course):
    for number in range(KEPT + 3):
        write(course, number)
        back_up(course)
    assert len(backups(course)) == KEPT
    assert things(backups(course)[0]) == [0, 1, 2, 3]


def test_a_backup_is_restored_by_copying_it(course):
    write(course, 1)
    back_up(course)
    course.database.write_bytes(b'scrap' * 1000)
    with pytest.raises(GradebookError, match='is damaged'):
        recover_and_back_up(course)
    [backup] = backups(course)  # none of the damaged database
    shutil.copy(backup, course.database)
    recover_and_back_up(course)
    assert things(course.database) == [1]


def test_a_damaged_database_is_refused_and_not_backed_up(course):
    write(course, 1)
    with closing(sqlite3.connect(course.database)) as database:
        database.executemany('INSERT INTO some VALUES (?)', [['x' * 500]] * 200)
        database.commit()
    back_up(course)
    raw = bytearray(course.database.read_bytes())
    raw[5 * 4096 : 7 * 4096] = b'\xff' * 8192
    course.database.write_bytes(raw)
    with pytest.raises(GradebookError, match='is damaged'):
        recover_and_back_up(course)
    assert len(backups(course)) == 1
