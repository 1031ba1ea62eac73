import csv
import shutil

import pytest
from course_maker import TOY, add_lesson, answered, executed, released_course, submit
from stored_grades import grade

from grader.__main__ import main
from grader.export.scores import write_scores
from grader.export.totals import add_up, as_csv, write_totals
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.storage.gradebook import store
from grader.storage.pipeline import sanitize_restored
from grader.storage.records import CellScore


def cell(student, assignment, score, most, *, submitted=True, name='check'):
    return CellScore(student, assignment, name, score, most, submitted=submitted)


CLASS = [
    cell('ada', '00_arm', 1.0, 1.0),
    cell('ada', '00_arm', 1.5, 2.0, name='other'),
    cell('ada', '01_topics', None, 2.0),
    cell('ada', '00_arm', -0.5, 0.0, name='late_penalty'),
    cell('=bob', '00_arm', None, 1.0, submitted=False),
    cell('=bob', '00_arm', None, 2.0, submitted=False, name='other'),
    cell('=bob', '01_topics', 0.0, 2.0),
]


def test_each_student_has_a_score_for_each_assignment_and_a_total():
    totals = add_up(CLASS)
    assert totals.assignments == ('00_arm', '01_topics')
    assert (totals.max_scores, totals.max_score) == ((3.0, 2.0), 5.0)
    bob, ada = totals.students
    assert (ada.scores, ada.total, ada.waiting) == ((2.0, 0.0), 2.0, 1)
    assert (bob.scores, bob.total, bob.waiting) == ((None, 0.0), 0.0, 0)


def test_a_sum_of_tenths_has_no_rounding_error():
    tenths = [cell('ada', '00_arm', score, 1.0, name=str(score)) for score in (0.7, 0.1, 0.1)]
    totals = add_up([*tenths, cell('ada', '01_topics', 0.3, 1.0)])
    assert (totals.students[0].scores, totals.students[0].total) == ((0.9, 0.3), 1.2)


def test_the_table_of_totals_leaves_missing_submissions_empty_and_has_no_formula():
    rows = list(csv.reader(as_csv(add_up(CLASS)).lstrip('\ufeff').splitlines()))
    assert rows == [
        ['student_id', '00_arm (of 3)', '01_topics (of 2)', 'total (of 5)', 'waiting'],
        ["'=bob", '', '0.0', '0.0', '0'],
        ['ada', '2.0', '0.0', '2.0', '1'],
    ]


@pytest.fixture
def course(tmp_path):
    return released_course(tmp_path)


def test_the_totals_are_those_of_the_gradebook(course, capsys):
    submit(course, 'ada', answered(course, 'def double(x):\n    return x + x'))
    folder = course.folder('submitted', 'ada', TOY)
    submission = read_submission(folder, student_id='ada', assignment=TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    stored = store(course, submission, executed(sanitize_restored(course, TOY, restored), {}))
    assert main(['scores', '--totals'], course=course) == 0
    path = write_totals(course)
    assert str(path) in capsys.readouterr().out
    rows = list(csv.reader(path.read_text(encoding='utf-8-sig').splitlines()))
    assert rows[0] == ['student_id', f'{TOY} (of 5)', 'total (of 5)', 'waiting']
    assert rows[1] == ['ada', str(stored.score), str(stored.score), '0']


def test_a_gradebook_without_students_gives_an_empty_table(course):
    assert len(write_totals(course).read_text(encoding='utf-8-sig').splitlines()) == 1


def heads_of(course):
    assert main(['scores', '--totals'], course=course) == 0
    path = course.gradebook / 'totals.csv'
    return next(csv.reader(path.read_text(encoding='utf-8-sig').splitlines()))[1:-1]


def test_a_withdrawn_lesson_counts_only_if_a_student_has_a_score_in_it(course, capsys):
    grade(course, 'ada', {})
    add_lesson(course, '01_more')
    assert heads_of(course) == [f'{TOY} (of 5)', '01_more (of 5)', 'total (of 10)']
    shutil.rmtree(course.root / 'solutions' / '01_more')
    assert heads_of(course) == [f'{TOY} (of 5)', 'total (of 5)']
    assert '01_more' not in write_scores(course).read_text(encoding='utf-8')
    assert 'no longer' not in capsys.readouterr().err
    add_lesson(course, '01_more')
    shutil.rmtree(course.root / 'solutions' / TOY)
    assert heads_of(course) == [f'{TOY} (of 5)', '01_more (of 5)', 'total (of 10)']
    assert capsys.readouterr().err == (
        f'{TOY} is in solutions/ no longer, and still counts, with the scores of 1 student. To '
        f'delete them: .venv/bin/nbgrader db assignment remove {TOY} --force\n'
    )
