"""What an instructor does with a class: the same files and words as in SQLite, byte for byte."""

import subprocess

import pytest
import quick_serve
from course_maker import TOY, add_lesson, answered, released_course, submit
from nbgrader.api import Gradebook
from postgresql_server import nbgrader, released_in, students_in
from sqlalchemy.exc import OperationalError

from grader.__main__ import main
from grader.export.totals import write_totals
from grader.serving import steps
from grader.serving.queue import GRADED
from grader.storage.backups import back_up

pytestmark = [pytest.mark.slow, pytest.mark.starts]

RULES = """
[late]
per_day = 0.1
at_most = 0.5
grace_minutes = 15
"""
CLASS = {
    # name: (time of submission, whether the written question is answered)
    'zoe': ('2026-03-01 10:00:00 UTC', True),
    'ada': ('2026-03-29 21:59:59 UTC', True),
    'Zed': ('2026-03-31 22:00:01 UTC', True),
    'Ödön': ('2026-04-09 10:00:00 UTC', False),
    '李雷': ('2026-03-29 22:30:00 UTC', True),
    'Lovelace, Ada': (None, True),
    'éva': ('2026-03-30 10:00:00 UTC', True),
}
WRONG = ('Zed', 'éva')
SECRET = 'ab' * 32


@pytest.fixture
def course(tmp_path, postgresql):
    return released_in(postgresql, tmp_path / 'course')


@pytest.fixture
def both(tmp_path, postgresql):
    """Two courses with the same class: one in SQLite, and one in PostgreSQL."""
    courses = [
        released_course(tmp_path / 'sqlite'),
        released_in(postgresql, tmp_path / 'postgresql'),
    ]
    for course in courses:
        (course.gradebook / 'course_secret').write_text(SECRET)
        for student, (when, explains) in CLASS.items():
            hand_in(course, student, when, explains=explains)
    return courses


def hand_in(course, student, when, *, explains=True, answer=''):
    right = quick_serve.WRONG if student in WRONG else quick_serve.RIGHT
    explained = f'Because of {student}.' if explains else ''
    path = submit(course, student, answered(course, answer or right, explained=explained))
    if when:
        path.with_name('timestamp.txt').write_text(when)


def give_by_hand(course, student, points, comment):
    """Do what the formgrader does."""
    with Gradebook(course.db_url) as book:
        found = book.find_grade('explain', TOY, TOY, student)
        found.manual_score, found.needs_manual_grade = points, False
        book.find_comment('explain', TOY, TOY, student).manual_comment = comment
        book.db.commit()


class Journey:
    """Does the same in two courses, and asserts that the results are equal."""

    def __init__(self, courses, capfd):
        self.courses, self.capfd = courses, capfd

    def run(self, *verb):
        """Call a verb in both courses; return their output, which has to be equal."""
        found = []
        for course in self.courses:
            with quick_serve.without_rooms():
                status = main([*verb], course=course)
            out, err = self.capfd.readouterr()
            found.append((status, plain(out, course), plain(err, course)))
        assert found[0] == found[1]
        return found[0][1] + found[0][2]

    def nbgrader(self, *arguments):
        """Run a command of nbgrader's, which succeeds."""
        done = [nbgrader(course, *arguments) for course in self.courses]
        assert [each.returncode for each in done] == [0, 0], [each.stderr for each in done]
        assert [each for each in done if 'Traceback' in each.stderr] == []

    def file(self, name):
        """Return the text of a file, which has to be the same in both courses."""
        texts = [(course.root / name).read_bytes() for course in self.courses]
        assert texts[0] == texts[1]
        return texts[0].decode('utf-8-sig')

    def files(self, pattern):
        """Return files by their names; names and contents have to be the same in both courses."""
        found = [
            {str(p.relative_to(c.root)): p.read_bytes() for p in c.gradebook.glob(pattern)}
            for c in self.courses
        ]
        assert found[0] == found[1]
        return found[0]


def plain(text, course):
    return text.replace(str(course.root), 'COURSE')


def test_late_penalties_manual_points_and_tables_equal_those_of_sqlite(both, capfd):
    journey = Journey(both, capfd)
    for course in both:
        (course.gradebook / 'deadlines.toml').write_text(RULES)
        quick_serve.grade_here(course)
    journey.run('due', TOY, '2026-03-29T23:59+02:00')
    for verb in ('scores', 'feedback'):
        journey.run(verb)
    journey.run('scores', '--totals')
    before = journey.file('gradebook/totals.csv')
    assert '李雷,2.7,' in before
    journey.run('due', TOY, '2026-04-10', '--student', 'Ödön')
    for course in both:
        for student, points in (('ada', 1.9), ('李雷', 2.0), ('éva', 0.7), ('Lovelace, Ada', 0.1)):
            give_by_hand(course, student, points, f'für {student}: 好')
    journey.run('scores', '--totals')
    after = journey.file('gradebook/totals.csv')
    assert '李雷,4.5,' in after
    assert before != after
    journey.run('scores')
    assert 'für 李雷: 好' in journey.file('gradebook/scores.csv')
    journey.run('feedback')
    assert len(journey.files('feedback/*/*/*.html')) == len(CLASS)
    for course in both:
        hand_in(course, 'zoe', '2026-04-02 10:00:00 UTC', answer=f'# again\n{quick_serve.RIGHT}')
        quick_serve.grade_here(course)
    journey.run('scores', '--totals')
    assert 'zoe,1.8,' in journey.file('gradebook/totals.csv')
    for form in ('moodle', 'canvas'):
        journey.run('scores', '--format', form)
    for course in both:
        add_lesson(course, '01_more')  # without a due date
    journey.nbgrader('db', 'student', 'add', 'ada', '--last-name', 'Ödland')
    journey.nbgrader('export', '--to', 'export.csv')
    first, last = journey.file('export.csv').splitlines()[1 :: 2 * len(CLASS) - 1]
    assert first.startswith('01_more,,,"Lovelace, Ada",')
    assert last.startswith(f'{TOY},2026-03-29 21:59:00,2026-03-29 21:59:59,ada,Ödland,')


def test_removing_a_student_or_a_lesson_has_the_same_effect_as_in_sqlite(both, capfd):
    journey = Journey(both, capfd)
    for course in both:
        quick_serve.grade_here(course)
    journey.run('feedback')
    journey.nbgrader('db', 'student', 'remove', 'Zed', '--force')
    said = journey.run('feedback')
    assert 'Zed has no page of feedback: the database has no scores of it.' in said
    journey.run('scores', '--totals')
    assert 'Zed' not in journey.file('gradebook/totals.csv')
    for course in both:
        course.source_path(TOY).unlink()
    said = journey.run('scores', '--totals')
    counted = 'and still counts, with the scores of 6 students'
    assert f'{TOY} is in solutions/ no longer, {counted}' in said
    assert f'{TOY} (of 5)' in journey.file('gradebook/totals.csv')
    journey.nbgrader('db', 'assignment', 'remove', TOY, '--force')
    assert 'no longer' not in journey.run('scores', '--totals')
    assert TOY not in journey.file('gradebook/totals.csv')


def test_a_backup_can_be_restored_as_documented(course, postgresql, capfd):
    for student in ('ada', 'bob'):
        hand_in(course, student, None)
    quick_serve.grade_here(course)
    give_by_hand(course, 'ada', 1.5, 'good')
    dump = back_up(course)
    totals = write_totals(course).read_bytes()
    hand_in(course, 'zoe', None)
    give_by_hand(course, 'ada', 0.5, 'a slip')
    quick_serve.grade_here(course)
    assert write_totals(course).read_bytes() != totals
    restore = ['pg_restore', '--clean', '--if-exists', '--single-transaction']
    address = course.db_url.replace('+psycopg', '').partition('?')[0]
    done = subprocess.run(
        [postgresql.programs / restore[0], *restore[1:], f'--dbname={address}', dump], check=False
    )
    assert done.returncode == 0
    assert write_totals(course).read_bytes() == totals
    with quick_serve.without_rooms():
        assert main(['feedback'], course=course) == 0
    assert '00_toy of zoe has no page of feedback: ' in capfd.readouterr().out
    assert {row.student_id: row.reused for row in quick_serve.grade_here(course)} == {
        'ada': True,
        'bob': True,
        'zoe': False,
    }
    assert students_in(course) == ['ada', 'bob', 'zoe']


def test_a_submission_that_arrives_while_the_server_is_away_is_graded_later(
    course, postgresql, tmp_path, monkeypatch
):
    inbound = quick_serve.exchange_in(tmp_path)
    quick_serve.hand_in(course, inbound, 'ada', quick_serve.WRONG)
    quick_serve.serve_here(course, inbound)
    quick_serve.hand_in(course, inbound, 'ada', quick_serve.RIGHT, number=2)
    put = steps.put_in_place

    def when_it_is_away(*given):
        postgresql.stop()
        return put(*given)

    with monkeypatch.context() as patch:
        patch.setattr(steps, 'put_in_place', when_it_is_away)
        with pytest.raises(OperationalError):
            quick_serve.serve_here(course, inbound)
    postgresql.start()
    said = quick_serve.serve_here(course, inbound)
    assert [each.partition(':')[0] for each in said] == ['graded']
    assert [each.state for each in quick_serve.arrivals(course)] == [GRADED, GRADED]
    assert 'ada,3.0,' in write_totals(course).read_text(encoding='utf-8')
