import csv
import io
import re
import shutil
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import pytest
from course_maker import TOY, add_lesson, answered, executed, submit
from nbgrader.api import Grade, Gradebook, SubmittedAssignment, SubmittedNotebook
from sqlalchemy import event
from sqlalchemy.engine import Engine

from grader.common.errors import CourseError
from grader.course import ROOT, Course
from grader.export.scores import write_scores
from grader.export.totals import write_totals
from grader.grade import grade_all
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.report.feedback import write_feedback
from grader.storage.deadlines import (
    FILE,
    Deadlines,
    deadlines,
    extended_for_nobody,
    read_deadlines,
)
from grader.storage.gradebook import store
from grader.storage.lateness import recount_late_penalties
from grader.storage.pipeline import sanitize_restored
from grader.storage.records import records
from grader.storage.registering import register

RULES = f"""
[due]
{TOY} = 2026-01-10T23:59:00+01:00

[extended.{TOY}]
ada = 2026-01-12T23:59:00+01:00
'小明' = 2026-01-01T00:00:00Z

[late]
per_day = 0.1
at_most = 0.5
grace_minutes = 15
"""


@pytest.fixture
def course(released, tmp_path):
    shutil.copytree(released.gradebook, tmp_path / 'gradebook')  # making a database takes long
    return Course(root=released.root, gradebook=tmp_path / 'gradebook')


def grade(course, student, handed_in):
    """Store a submission that earns 3 points; return its score, which is reduced if it is late."""
    path = submit(course, student, answered(course, 'def double(x):\n    return 2 * x'))
    if handed_in:
        path.with_name('timestamp.txt').write_text(handed_in)
    submission = read_submission(path.parent, student_id=student, assignment=TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    stored = store(course, submission, executed(sanitize_restored(course, TOY, restored), {}))
    assert stored.score + stored.late == pytest.approx(3.0)
    return stored.score


def give_by_hand(course, student, points):
    """Do what the formgrader does."""
    with Gradebook(course.db_url) as book:
        found = book.find_grade('explain', TOY, TOY, student)
        found.manual_score, found.needs_manual_grade = points, False
        book.db.commit()


@pytest.mark.parametrize(
    ('student', 'handed_in', 'score'),
    [
        ('bob', '2026-01-10 22:59:00 UTC', 3.0),
        ('bob', '2026-01-10 23:14:00 UTC', 3.0),  # in the minutes of grace
        ('bob', '2026-01-10 23:14:01 UTC', 2.7),
        ('bob', '2026-01-11 22:59:01 UTC', 2.4),
        ('bob', '2026-06-01 00:00:00 UTC', 1.5),
        ('bob', None, 3.0),
        ('ada', '2026-01-12 22:59:00 UTC', 3.0),
        ('ada', '2026-01-12 23:30:00 UTC', 2.7),
        ('小明', '2026-01-10 22:00:00 UTC', 3.0),  # no extension makes the time shorter
    ],
)
def test_a_late_submission_loses_points_by_the_rules_of_the_file(
    student, handed_in, score, course
):
    (course.gradebook / FILE).write_text(RULES)
    assert grade(course, student, handed_in) == pytest.approx(score)


def test_the_gradebook_has_due_date_extension_and_late_penalty(course):
    (course.gradebook / FILE).write_text(RULES)
    grade(course, 'ada', '2026-01-13 22:59:00 UTC')
    with Gradebook(course.db_url) as book:
        assert book.find_assignment(TOY).duedate == datetime(2026, 1, 10, 22, 59)
        submission = book.find_submission(TOY, 'ada')
        assert (submission.extension.days, submission.total_seconds_late) == (2, 86_400)
    found = {record.grade_id: record.score for record in records(course)}
    assert found['late_penalty'] == -0.3


def test_a_penalty_is_the_same_rounded_number_in_all_tables(course):
    (course.gradebook / FILE).write_text(RULES)
    assert grade(course, 'bob', '2026-01-13 22:58:00 UTC') == 2.1  # 3 - 0.9
    assert ',late_penalty,-0.9,' in write_scores(course).read_text(encoding='utf-8')
    assert 'bob,2.1,2.1,' in write_totals(course).read_text(encoding='utf-8')
    with Gradebook(course.db_url) as book:
        assert book.find_submission(TOY, 'bob').late_submission_penalty == 0.9


def test_a_late_penalty_also_reduces_points_given_by_hand(course, caplog):
    (course.gradebook / FILE).write_text(RULES)
    grade(course, 'bob', '2026-01-13 22:58:00 UTC')
    grade(course, 'ada', '2026-01-10 22:58:00 UTC')
    for student in ('ada', 'bob'):
        give_by_hand(course, student, 2.0)
    write_totals(course)
    assert {row.student_id: row.score for row in records(course) if not row.max_score} == {
        'bob': -1.5
    }
    give_by_hand(course, 'bob', 1.0)
    (page,) = (each for each in write_feedback(course) if 'bob' in each.parts)
    assert '2.8 of 5 points' in page.read_text(encoding='utf-8')  # 4 - 1.2
    assert caplog.text == ''  # the page says so to the student


def test_a_penalty_is_rounded_to_hundredths_of_a_point():
    rules = Deadlines(per_day=0.1)
    assert [rules.penalty(points, 86_400) for points in (3, 0.33, 7 / 3)] == [0.3, 0.03, 0.23]


def test_rules_removed_from_the_file_no_longer_apply(course):
    for rules, score in ((RULES, 2.7), (RULES.partition('[late]')[0], 3.0), (RULES, 2.7), ('', 3)):
        (course.gradebook / FILE).write_text(rules)
        assert grade(course, 'bob', '2026-01-11 22:59:00 UTC') == pytest.approx(score)


def test_nbgraders_own_due_date_costs_nothing_without_a_file_of_deadlines(course):
    assert deadlines(course.gradebook) is None
    with Gradebook(course.db_url) as book:
        book.find_assignment(TOY).duedate = datetime(2026, 1, 1)
        book.db.commit()
    assert grade(course, 'bob', '2026-01-11 22:59:00 UTC') == 3.0
    with Gradebook(course.db_url) as book:
        assert book.find_submission(TOY, 'bob').total_seconds_late > 0


@pytest.mark.parametrize(
    ('rules', 'wrong'),
    [
        ('[due', 'at end of document'),
        ('[dues]', "'dues' is not a name that"),
        ('due = 1', r'due must be a table'),
        ('[due]\n99_other = 2026-01-01T00:00:00Z', "there is no assignment '99_other'"),
        (f'[due]\n{TOY} = 2026-01-01T00:00:00', 'must have a date and a time with its zone'),
        (f'[due]\n{TOY} = 2026-01-01', 'must have a date and a time with its zone'),
        (f'[due]\n{TOY} = "tomorrow"', 'must have a date and a time with its zone'),
        (
            f'[extended.{TOY}]\nada = 2026-01-01T00:00:00Z',
            r'is in \[extended\], but has no date in \[due\]',
        ),
        ('[late]\nper_week = 0.1', "'per_week' is not a name that"),
        ('[late]\nper_day = "10 %"', 'per_day must be a number'),
        ('[late]\nper_day = 10', 'per_day = 10 is out of range: expected 0 to 1'),
        ('[late]\nat_most = -1', 'at_most = -1 is out of range: expected 0 to 1'),
        ('[late]\nper_day = nan', 'per_day = nan is out of range: expected 0 to 1'),
        ('[late]\ngrace_minutes = -1', 'grace_minutes = -1 is out of range: expected 0 or more'),
    ],
)
def test_a_fault_in_the_file_of_deadlines_is_reported_before_grading(rules, wrong, course):
    (course.gradebook / FILE).write_text(rules)
    with pytest.raises(CourseError, match=f'{FILE}: .*{wrong}.* has an example'):
        list(grade_all(course, [], trust_students=True))


def test_each_late_day_that_has_begun_counts():
    rules = Deadlines(per_day=0.2)
    assert [rules.penalty(10, days * 86_400) for days in (0, 0.01, 1, 1.01, 9)] == [
        None,
        *(2.0, 2.0, 4.0, 10.0),
    ]


def test_an_extension_for_a_student_without_a_submission_is_reported(course):
    (course.gradebook / FILE).write_text(RULES)
    submit(course, 'ada', '')
    assert extended_for_nobody(course) == [
        f'{FILE} extends {TOY} for 小明, who has not handed it in yet: '
        'check that the name is right'
    ]
    submit(course, '小明', '')
    assert extended_for_nobody(course) == []
    (course.gradebook / FILE).unlink()
    assert extended_for_nobody(course) == []


def test_a_late_penalty_reduces_the_score_and_is_not_logged(course, caplog):
    (course.gradebook / FILE).write_text(RULES)
    assert grade(course, 'bob', '2026-01-11 23:59:00 UTC') < 3.0
    assert caplog.text == ''


def test_the_example_of_the_document_for_instructors_is_read_correctly():
    page = (ROOT / 'docs/for-instructors.md').read_text(encoding='utf-8')
    (example,) = re.findall(r'```toml\n(\[late\].*?)```', page, re.DOTALL)
    found = read_deadlines(example.encode(), Path(FILE))
    assert (found.per_day, found.at_most, found.grace_minutes) == (0.1, 0.5, 15)
    limits = found.resubmissions
    assert (limits.per_hour, limits.in_total) == (6, 30)


def given(course):
    return {row.student_id: row.score for row in records(course) if not row.max_score}


def test_a_due_date_that_is_set_later_counts_in_the_next_table(course):
    grade(course, 'bob', '2026-01-11 22:00:00 UTC')
    grade(course, 'ada', '2026-01-11 22:00:00 UTC')
    _, late = RULES.split('[late]')
    (course.gradebook / FILE).write_text(f'[late]{late}')
    assert given(course) == {}
    (course.gradebook / FILE).write_text(RULES)
    assert given(course) == {'bob': -0.3}  # ada has an extension
    (course.gradebook / FILE).write_text(RULES.replace('01-10', '01-11').replace('01-12', '01-13'))
    assert given(course) == {}
    (course.gradebook / FILE).write_text(f'[due]\n{TOY} = 2026-01-10T22:59:00Z\n[late]{late}')
    assert given(course) == {'ada': -0.3, 'bob': -0.3}
    (course.gradebook / FILE).write_text('')
    assert given(course) == {}


def exported(course, *arguments):
    """Let nbgrader's own command write its table; return its rows, or its errors."""
    run = nbgrader_export(course, '--to', 'export.csv', *arguments)
    if run.returncode:
        return run.stderr
    return table((course.root / 'export.csv').read_text(encoding='utf-8'))


def table(text):
    return {row['student_id']: row for row in csv.DictReader(io.StringIO(text))}


def nbgrader_export(course, *arguments, db_url=None):
    return subprocess.run(
        [
            *(sys.executable, '-P', '-m', 'nbgrader', 'export', *arguments),
            f'--CourseDirectory.db_url={db_url or course.db_url}',
        ],
        cwd=course.root,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.starts
def test_nbgraders_own_table_has_current_penalties_and_names_with_a_comma(course):
    (course.gradebook / FILE).write_text(RULES)
    grade(course, 'Lovelace, Ada', '2026-01-13 22:58:00 UTC')
    grade(course, 'bob', '2026-01-10 22:58:00 UTC')
    give_by_hand(course, 'Lovelace, Ada', 2.0)
    rows = exported(course)
    assert [*rows] == ['Lovelace, Ada', 'bob']
    wanted = {'raw_score': '5.0', 'late_submission_penalty': '1.5', 'score': '3.5'}
    assert wanted.items() <= rows['Lovelace, Ada'].items()
    assert [*exported(course, '--student', "['bob']")] == ['bob']
    (course.gradebook / FILE).write_text('[late]\nper_day = 2\n')
    assert 'per_day = 2 is out of range: expected 0 to 1. Correct it: docs/' in exported(course)


@pytest.mark.starts
def test_nbgraders_own_table_omits_a_lesson_withdrawn_before_any_submission(course):
    grade(course, 'bob', None)
    add_lesson(course, '01_more')
    try:
        assert exported(course)['bob']['assignment'] == '01_more'  # the last of two rows
    finally:
        shutil.rmtree(course.root / 'solutions' / '01_more')
    assert exported(course)['bob']['assignment'] == TOY
    assert exported(course, '--assignment', "['01_more']")['bob']['assignment'] == '01_more'


@pytest.mark.starts
def test_nbgraders_own_table_follows_a_link_and_reports_a_missing_folder(course, tmp_path):
    """Such as /dev/stdout, which root could replace with a file."""
    grade(course, 'bob', None)
    link, target = tmp_path / 'link.csv', tmp_path / 'target.csv'
    link.symlink_to(target)
    assert nbgrader_export(course, '--to', str(link)).returncode == 0
    assert link.is_symlink()
    assert [*table(target.read_text(encoding='utf-8'))] == ['bob']
    run = nbgrader_export(course, '--to', str(tmp_path / 'none' / 'x.csv'))
    assert run.stderr.splitlines()[-1].endswith(
        'x.csv cannot be written: No such file or directory; name another file with --to'
    )


@pytest.mark.starts
def test_a_backup_is_exported_as_it_is_and_nothing_is_put_beside_it(course, tmp_path):
    (course.gradebook / FILE).write_text(RULES)
    grade(course, 'bob', '2026-01-13 22:58:00 UTC')
    backup = tmp_path / 'backups' / '2026-01-14.db'
    backup.parent.mkdir()
    shutil.copy(course.database, backup)
    (backup.parent / FILE).write_text('')
    run = nbgrader_export(course, '--to', 'backup.csv', db_url=f'sqlite:///{backup}')
    assert run.returncode == 0, run.stderr
    rows = table((course.root / 'backup.csv').read_text(encoding='utf-8'))
    assert rows['bob']['late_submission_penalty'] == '0.9'
    assert sorted(each.name for each in backup.parent.iterdir()) == [backup.name, FILE]


def steps_of_a_recount(course, students, handed_in):
    """Let these students earn a point; return the steps of SQLite in a recount, in hundreds."""
    with Gradebook(course.db_url) as book:
        notebook = book.find_notebook(TOY, TOY)
        cell = notebook.grade_cells[0]
        for number in students:
            submission = SubmittedAssignment(
                student=book.add_student(f'student_{number}'),
                assignment=notebook.assignment,
                timestamp=handed_in,
            )
            submitted = SubmittedNotebook(assignment=submission, notebook=notebook)
            book.db.add(Grade(cell=cell, notebook=submitted, auto_score=1.0))
        book.db.commit()
    steps = []

    def count(connection, _):
        connection.set_progress_handler(lambda: steps.append(1), 100)

    event.listen(Engine, 'connect', count)
    try:
        recount_late_penalties(course)
    finally:
        event.remove(Engine, 'connect', count)
    return len(steps)


@pytest.mark.parametrize('day', [1, 11])
def test_recounting_penalties_takes_time_in_proportion_to_the_class(course, day):
    handed_in = datetime(2026, 1, day)
    (course.gradebook / FILE).write_text(RULES)
    register(course, TOY)
    recount_late_penalties(course)  # the date is new
    few = steps_of_a_recount(course, range(50), handed_in)
    many = steps_of_a_recount(course, range(50, 200), handed_in)
    assert 0 < few <= many <= 6 * few
