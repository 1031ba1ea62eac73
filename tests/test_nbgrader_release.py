"""`nbgrader release_feedback`, and the formgrader's button: each page that can be is released."""

import pytest
from course_maker import TOY, released_course
from nbgrader.utils import notebook_hash
from nbgrader_command import run_nbgrader

pytestmark = pytest.mark.starts
SECRETS = {'ada': b'', 'bob': b'\xff', 'cem': None, 'dan': b'of dan'}
"""What students handed in as submission_secret.txt; the last one did so as nbgrader does."""


def nbgrader_release(course, exchange, *options):
    return run_nbgrader('release_feedback', TOY, course=course, exchange=exchange, options=options)


@pytest.fixture
def course(tmp_path):
    course = released_course(tmp_path / 'course')
    for student, secret in SECRETS.items():
        folder = course.folder('feedback', student, TOY)
        folder.mkdir(parents=True)
        (folder / f'{TOY}.html').write_text(f'page of {student}')
        if secret is not None:
            (folder / 'submission_secret.txt').write_bytes(secret)
    return course


@pytest.fixture
def exchange(tmp_path):
    folder = tmp_path / 'exchange'
    folder.mkdir()
    return folder


def pages(exchange):
    return {page.name: page.read_text() for page in exchange.glob('robots/feedback/*')}


def test_a_secret_that_is_no_secret_keeps_nobody_else_from_feedback(course, exchange):
    done = nbgrader_release(course, exchange)
    assert done.returncode == 0, done.stdout
    own = f'{notebook_hash(secret="of dan", notebook_id=TOY)}.html'
    assert pages(exchange).pop(own) == 'page of dan'
    for student in ('ada', 'cem'):
        assert f'not released: {student} handed in without a submission_secret.txt' in done.stdout


def test_students_can_be_excluded(course, exchange):
    done = nbgrader_release(course, exchange, '--CourseDirectory.student_id_exclude=bob')
    assert {*pages(exchange).values()} == {'page of dan'}, done.stdout
