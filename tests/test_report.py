import json
import re
from datetime import UTC, datetime

import pytest
from course_maker import TOY, answered, executed, submit
from nbformat.v4 import new_code_cell, new_notebook
from nbgrader.api import Gradebook

from grader.cli.demo import demo
from grader.course import Course
from grader.grading import SubmissionOutcome
from grader.notebook.restore import NO_ANSWERS, restore
from grader.notebook.submission import read_submission
from grader.report.report import Run, write_report
from grader.report.statistics import WRITTEN, tally
from grader.storage.gradebook import store
from grader.storage.pipeline import make_sanitized_template, make_unanswered, sanitize_restored
from grader.storage.records import records

ANSWER = 'def double(x):\n    return x + x'
SCRIPT = '<script>alert("from a student")</script>'
RUN = Run(datetime(2026, 11, 21, 8, 30, tzinfo=UTC))


@pytest.fixture
def course(released, tmp_path):
    gradebook = tmp_path / 'gradebook'
    gradebook.mkdir()
    # making a database takes long
    (gradebook / 'gradebook.db').write_bytes((released.gradebook / 'gradebook.db').read_bytes())
    return Course(root=released.root, gradebook=gradebook)


def graded(course, student, reasons=None, *, explained='so', seconds=1.0, notebook=None):
    """Store a submission with made-up verdicts; return its row."""
    submit(course, student, notebook or answered(course, ANSWER, explained=explained))
    folder = course.folder('submitted', student, TOY)
    submission = read_submission(folder, student_id=student, assignment=TOY)
    if submission.problem:
        judged = make_unanswered(make_sanitized_template(course, TOY), submission.problem)
    else:
        restored = restore(submission.notebook, course.template(TOY)).notebook
        judged = executed(sanitize_restored(course, TOY, restored), reasons or {})
    stored = store(course, submission, judged)
    return SubmissionOutcome(student, TOY, stored, stored.reason, seconds)


def reported(course, rows, run=RUN):
    page = write_report(course, run, rows)
    facts = json.loads(page.with_suffix('.json').read_text(encoding='utf-8'))
    return facts, page.read_text(encoding='utf-8')


def test_a_reason_lists_all_its_students_and_the_most_common_one_comes_first(course):
    rows = [
        graded(course, 'ada', {'double-hidden': 'expected 42, saw 1: count again'}),
        graded(
            course,
            'bob',
            {
                'double-check': 'expected 2, saw 17: count again',
                'double-hidden': 'expected 42, saw 17: count again',
            },
        ),
        graded(course, 'eve', {'double-check': 'gave none in 2 s'}),
    ]
    first, second = tally(course, rows, records(course)).reasons
    assert first.words == 'expected …, saw …: count again'
    assert first.students == ('ada', 'bob')
    assert first.checks == ('double-hidden', 'double-check')
    assert (second.students, second.words) == (('eve',), 'gave none in 2 s')
    _, html = reported(course, rows)
    reasons = html.partition('Why points are missing')[2]
    assert reasons.index('2 students') < reasons.index('1 student')


def words_of(html):
    """Return the text and the labels of a page, without styles and code."""
    html = re.sub('<style>.*?</style>|<code>.*?</code>', '', html, flags=re.DOTALL)
    labels = re.findall('aria-label="(.*?)"', html)
    return ' '.join([*labels, re.sub('<[^>]*>', ' ', html)])


def test_the_report_page_is_in_the_requested_language_and_the_json_is_not(course):
    rows = [
        graded(course, 'ada', {}),
        graded(course, '小明', {'double-hidden': 'expected 2, saw 17: x'}, explained=''),
        graded(course, 'eve', notebook=b'no notebook'),
    ]
    facts, english = reported(course, rows)
    later = Run(RUN.began.replace(minute=31))
    page = write_report(course, later, rows, language='zh_CN')
    chinese = page.read_text(encoding='utf-8')
    assert '<html lang="en">' in english
    assert '<html lang="zh-CN">' in chinese
    assert 'Results of this class' in english
    assert '这个班级的结果' in chinese
    assert 'expected 2, saw 17: x' in words_of(english)
    assert '预期：2；实际：17' in words_of(chinese)
    assert '由人' in words_of(chinese)
    assert re.search(r'\d 名学生\s*；\s*平均', words_of(chinese))
    left = re.findall(r'(?:\b[a-z]{2,} ){3,}', words_of(chinese))
    assert {words for words in left if 'numbers are doubled' not in words} == set()  # the toy's
    theirs = json.loads(page.with_suffix('.json').read_text(encoding='utf-8'))
    for volatile in ('began', 'seconds', 'per_minute'):
        facts.pop(volatile), theirs.pop(volatile)
    assert theirs == facts  # programs read it: it is not translated


def test_each_check_has_the_share_of_scored_students_who_passed(course):
    rows = [
        graded(course, 'ada', {}),
        graded(course, 'bob', {'double-check': 'no'}),
        graded(course, 'eve', {'double-check': '?'}, explained=''),
    ]
    (toy,) = tally(course, rows, records(course)).assignments
    assert [(c.grade_id, c.passed, c.missed, c.waiting, c.rate) for c in toy.checks] == [
        ('double-check', 1, 1, 1, 0.5),
        ('double-hidden', 3, 0, 0, 1.0),
        ('explain', 0, 1, 2, 0.0),
    ]
    assert toy.checks[0].title == 'Small numbers are doubled'
    assert (toy.scores, toy.mean, toy.median) == ((2.0, 2.0, 3.0), 7 / 3, 2.0)


def test_each_submission_or_check_that_needs_a_person_is_listed_with_its_reason(course):
    rows = [
        graded(course, 'ada', {}),
        graded(course, 'bob', {'double-check': '?'}, explained=''),
        graded(course, 'eve', notebook=b'no notebook'),
        graded(course, 'zoe', {}, explained=''),
        graded(course, 'pat', {}, notebook=new_notebook(cells=[new_code_cell(ANSWER)])),
        SubmissionOutcome('x.ipynb', '', None, 'a file where a folder was expected'),
        SubmissionOutcome('kim', TOY, None, 'not graded, the grader failed: OSError: no room'),
    ]
    looks = tally(course, rows, records(course)).looks
    assert [(each.students, each.checks, each.words) for each in looks if each.checks] == [
        (('bob',), ('double-check',), '?'),
        (('ada',), ('explain',), WRITTEN),
    ]
    assert looks[-1].words == WRITTEN
    whole = {each.students: each.words for each in looks if not each.checks}
    assert whole.keys() == {('eve',), ('pat',), ('kim',), ('x.ipynb',)}
    assert whole['eve',].startswith('unreadable, so it earned nothing: 00_toy.ipynb is not JSON')
    assert whole['pat',] == NO_ANSWERS
    assert (whole['x.ipynb',], whole['kim',]) == (rows[5].reason, rows[6].reason)


def test_submissions_that_wait_for_the_same_reason_share_one_line(course):
    rows = [graded(course, name, {'double-check': '?'}) for name in ('ada', 'bob', 'eve')]
    broken, written = tally(course, rows, records(course)).looks
    assert (broken.words, broken.students) == ('?', ('ada', 'bob', 'eve'))
    assert (written.words, written.students) == (WRITTEN, ('ada', 'bob', 'eve'))
    facts, html = reported(course, rows)
    assert [each['count'] for each in facts['looks']] == [3, 3]
    assert html.count(WRITTEN) == 1


def test_the_check_that_most_students_missed_comes_first_with_its_commonest_reason(course):
    rows = [
        graded(course, 'ada', {'double-check': 'a', 'double-hidden': 'saw 1'}, explained=''),
        graded(course, 'bob', {'double-check': 'b'}, explained=''),
        graded(course, 'eve', {'double-check': 'b'}),
        graded(course, 'zoe', {}),
    ]
    counted = tally(course, rows, records(course))
    assert [(name, c.grade_id, c.missed) for name, c in counted.hardest] == [
        (TOY, 'double-check', 3),
        (TOY, 'explain', 2),
        (TOY, 'double-hidden', 1),
    ]
    check, by_hand, hidden = (check.why for _, check in counted.hardest)
    assert by_hand.words == 'there is no answer'
    assert (check.words, check.students) == ('b', ('bob', 'eve'))
    assert hidden.words == 'saw 1'
    _, html = reported(course, rows)
    section = html.partition('did not understand')[2].partition('</section>')[0]
    assert '75 % missed it' in section
    assert section.index('3 of 4') < section.index('2 of 4') < section.index('1 of 4')
    assert 'what waits for a person counts nothing yet' in html


def test_a_check_that_a_person_has_scored_waits_no_longer(course):
    row = graded(course, 'ada', {})
    with Gradebook(course.db_url) as book:
        book.find_grade('explain', TOY, TOY, 'ada').manual_score = 2.0
        book.db.commit()
    counted = tally(course, [row], records(course))
    assert counted.looks == ()
    assert counted.assignments[0].checks[2].passed == 1


def test_the_json_report_contains_counts_times_points_and_the_environment(course):
    rows = [
        graded(course, 'ada', {}, seconds=2.0),
        graded(course, 'bob', {}, seconds=9.5),
        graded(course, 'eve', {}, seconds=None),
        SubmissionOutcome('kim', TOY, None, 'not graded'),
    ]
    facts, html = reported(course, rows)
    assert facts['began'] == '2026-11-21T08:30:00+00:00'
    assert facts['counts'] == {
        'submissions': 4,
        'graded now': 2,
        'unchanged': 0,
        'wait for a person': 3,
        'could not be graded': 1,
    }
    assert [(each['student_id'], each['seconds']) for each in facts['slowest']] == [
        ('bob', 9.5),
        ('ada', 2.0),
    ]
    assert [each['points'] for each in facts['submissions']] == ['3/5 …', '3/5 …', '3/5 …', '–']
    assert facts['environment'].keys() >= {'Python', 'ros-jazzy-rclpy', 'nbgrader', 'isolation'}
    assert facts['assignments'][0]['version'] == course.version(TOY)[:12]
    assert all(value in html for value in facts['environment'].values() if "'" not in value)


def test_the_report_names_the_isolation_and_the_seed_of_a_replay(course, monkeypatch):
    rows = [graded(course, 'ada', {})]
    said = set()
    for sandbox in (True, False):
        monkeypatch.setattr(
            'grader.report.report.require_isolation', lambda trust_students, it=sandbox: it
        )
        said.add(reported(course, rows)[0]['environment']['isolation'])
    assert said == {'each submission in a sandbox', 'none: --trust-students'}
    facts, _ = reported(course, rows, Run(RUN.began, seed='abc'))
    assert facts['environment']['inputs of hidden tests'] == 'replayed from seed abc'


def test_text_from_students_is_escaped_in_the_report(course):
    rows = [
        graded(course, 'ada', {'double-check': f'expected 2, saw {SCRIPT}\x1b[31m\u202e: try'}),
        SubmissionOutcome(SCRIPT, SCRIPT, None, SCRIPT),
    ]
    facts, html = reported(course, rows)
    assert SCRIPT not in html
    assert html.count('&lt;script&gt;') >= 4
    assert not re.search('[\x00-\x08\x1b\u202e]', html + json.dumps(facts, ensure_ascii=False))
    assert "default-src 'none'; style-src 'unsafe-inline'" in html
    assert not re.search(r'(?i)<script|\son\w+=|javascript:|https?://', html)


def test_every_student_has_a_row_of_scores_even_if_not_graded_in_this_run(course):
    rows = [graded(course, 'ada'), graded(course, 'bob', {'double-hidden': 'wrong'}, explained='')]
    facts, page = reported(course, rows[:1])
    assert facts['totals']['max_scores'] == {TOY: 5.0}
    students = [(s['student_id'], *s['scores'], s['waiting']) for s in facts['totals']['students']]
    assert students == [('ada', 3.0, 1), ('bob', 1.0, 0)]
    score = f'<td role="cell" class="number" data-label="{TOY}">'
    assert f'<th role="rowheader" scope="row">bob</th>{score}1</td>' in page
    assert re.search(r'scope="row">ada</th>.* data-label="Total">3 …</td>', page)


def test_a_student_name_that_is_not_utf_8_is_reported_escaped(course):
    facts, _ = reported(course, [SubmissionOutcome('\udcff', '', None, 'not UTF-8')])
    assert facts['looks'][0]['students'] == ['\\udcff']


def test_runs_that_begin_in_the_same_second_keep_their_own_reports(course):
    rows = [graded(course, 'ada', {})]
    pages = [write_report(course, RUN, rows) for _ in range(3)]
    assert [page.parent.name for page in pages] == [
        '2026-11-21_08-30-00',
        '2026-11-21_08-30-00_2',
        '2026-11-21_08-30-00_3',
    ]
    assert sorted(path.name for path in pages[0].parent.iterdir()) == [
        'report.html',
        'report.json',
    ]


@pytest.mark.starts
def test_a_demo_writes_a_report(released, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr('tempfile.tempdir', str(tmp_path))
    samples = tmp_path / 'samples'
    samples.mkdir()
    (samples / f'{TOY}-fail-no_json.ipynb').write_text('')
    assert demo(samples, root=released.root)
    (page,) = tmp_path.glob('*/runs/*/report.html')
    assert f'A report of the run: {page}\n' in capsys.readouterr().out
