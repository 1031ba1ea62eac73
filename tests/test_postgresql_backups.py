"""Dumps of a gradebook in PostgreSQL, and how they are restored."""

import os
import subprocess

import pytest
from course_maker import TOY
from postgresql_server import PASSWORD, released_in, students_in

from grader.storage.backups import back_up
from grader.storage.database import transaction
from grader.storage.registering import register

pytestmark = [pytest.mark.slow, pytest.mark.starts]


@pytest.fixture
def course(tmp_path, postgresql):
    return released_in(postgresql, tmp_path / 'course')


def address_of(course):
    """Return the address as libpq's programs take it."""
    return course.db_url.replace('+psycopg', '').partition('?')[0]


def test_a_dump_is_made_once_for_each_state_and_can_be_restored(course, postgresql):
    assert back_up(course) is None  # there is nothing yet
    register(course, TOY)
    with transaction(course.db_url) as book:
        book.update_or_create_student('ada')
    first = back_up(course)
    assert first.suffix == '.dump'
    assert back_up(course) == first
    with transaction(course.db_url) as book:
        book.update_or_create_student('bob')
    second = back_up(course)
    assert sorted(first.parent.iterdir()) == [first, second]
    restore = [
        'pg_restore',
        '--clean',
        '--if-exists',
        '--single-transaction',
        f'--dbname={address_of(course)}',
    ]
    subprocess.run([postgresql.programs / restore[0], *restore[1:], first], check=True)
    assert students_in(course) == ['ada']
    assert not register(course, TOY)
    assert back_up(course) not in (first, second)


def test_a_missing_or_failing_pg_dump_is_reported_and_shows_no_password(
    course, monkeypatch, tmp_path, capsys
):
    register(course, TOY)
    monkeypatch.setenv('PATH', str(tmp_path))
    assert back_up(course) is None
    said = capsys.readouterr().err
    assert said.startswith('No backup of the database is made: there is no pg_dump here')
    (tmp_path / 'pg_dump').write_text('#!/bin/sh\necho "$@" >&2; env >&2; exit 1\n')
    (tmp_path / 'pg_dump').chmod(0o755)
    monkeypatch.setenv('PATH', f'{tmp_path}{os.pathsep}/bin')
    assert back_up(course) is None
    said = capsys.readouterr().err
    assert 'PGPASSWORD=***' in said
    assert 'dbname=course_' in said
    assert PASSWORD not in said
    assert list((course.gradebook / 'backups').iterdir()) == []
