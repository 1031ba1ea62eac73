"""What is handed back names the submissions whose newest files were not graded yet."""

import os
import time

import pytest
from course_maker import (
    TOY,
    answered,
    executed,
    released_course,
    submit,
    toy_lesson,
    write_source,
)

from grader.__main__ import main
from grader.authoring.release import release
from grader.notebook.restore import restore
from grader.notebook.submission import TIMESTAMP, read_submission
from grader.storage.gradebook import store
from grader.storage.pipeline import sanitize_restored
from grader.storage.reuse import files_digest, lesson_digest, write_key
from grader.storage.ungraded import ungraded

RIGHT = 'def double(x):\n    return x + x'


@pytest.fixture(scope='module')
def released(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('course'))


@pytest.fixture
def course(released):
    submit(released, 'ada', answered(released, RIGHT))
    grade(released, 'ada')
    return released


def grade(course, student):
    folder = course.folder('submitted', student, TOY)
    submission = read_submission(folder, student_id=student, assignment=TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    graded = executed(sanitize_restored(course, TOY, restored), {})
    write_key(graded, 'key', files_digest(submission), lesson_digest(course, TOY))
    store(course, submission, graded)


def make_newer(folder):
    """Give its files a later time than that of any result."""
    for path in folder.iterdir():
        os.utime(path, (time.time() + 60, time.time() + 60))


def named(course):
    return [(each.student_id, each.assignment) for each in ungraded(course)]


def test_a_graded_submission_is_not_named_even_if_its_files_were_copied_since(course):
    assert named(course) == []
    make_newer(course.folder('submitted', 'ada', TOY))
    assert named(course) == []


@pytest.mark.parametrize(
    ('name', 'text'),
    [
        (f'{TOY}.ipynb', '{}'),
        ('helper.py', 'x = 1'),
        (TIMESTAMP, '2026-01-02 03:04:05 UTC'),
    ],
)
def test_a_submission_with_other_files_than_its_result_is_named(course, name, text):
    folder = course.folder('submitted', 'ada', TOY)
    (folder / name).write_text(text)
    make_newer(folder)
    assert named(course) == [('ada', TOY)]
    (folder / name).unlink()


@pytest.mark.parametrize('asked', [['scores'], ['scores', '--totals'], ['feedback']])
def test_what_is_handed_back_names_a_new_submission(course, capsys, asked):
    submit(course, 'bob', answered(course, RIGHT))
    assert main(asked, course=course) == 0
    said = capsys.readouterr().err
    assert said == (
        f'New or changed, and not graded yet: bob {TOY}. What was written has an earlier result '
        'of these, or none. Next: ./course grade, then this again\n'
    )
    grade(course, 'bob')
    assert main(asked, course=course) == 0
    assert capsys.readouterr().err == ''
    for step in ('submitted', 'autograded'):
        (course.folder(step, 'bob', TOY) / f'{TOY}.ipynb').unlink()
        course.folder(step, 'bob', TOY).rmdir()


@pytest.mark.parametrize('asked', [['scores'], ['scores', '--totals'], ['feedback']])
def test_what_is_handed_back_names_a_lesson_that_has_changed_since(tmp_path, capsys, asked):
    """A check is worth more now: the table has the new points beside the earlier score."""
    course = released_course(tmp_path)
    submit(course, 'ada', answered(course, RIGHT))
    grade(course, 'ada')
    make_newer(course.source_path(TOY).parent)
    assert main(asked, course=course) == 0
    assert capsys.readouterr().err == ''
    changed = toy_lesson()
    changed.cells[6].metadata['nbgrader']['points'] = 5
    write_source(course, changed)
    release(course)
    assert main(asked, course=course) == 0
    assert capsys.readouterr().err == (
        f'Changed since submissions were graded: {TOY}. What was written has the earlier results. '
        'Next: ./course grade, then this again\n'
    )
    grade(course, 'ada')
    assert main(asked, course=course) == 0
    assert capsys.readouterr().err == ''
