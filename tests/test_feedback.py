import base64
import re
import shutil
import time
from html import unescape

import pytest
from course_maker import PIXEL, TOY, answered, executed, released_course, submit
from my_robot_basics.feedback.hidden import PLACE
from my_robot_basics.feedback.unanswered import say_unanswered
from nbformat.v4 import new_code_cell, new_output

from grader.common import parsing
from grader.common.parsing import AT_ONCE, Limits, ParsingFailed, parse
from grader.course import Course
from grader.notebook.restore import KEY, restore
from grader.notebook.submission import read_submission
from grader.report import feedback as module
from grader.report import page, page_parts
from grader.report.feedback import write_feedback
from grader.storage.database import open_database
from grader.storage.gradebook import store
from grader.storage.pipeline import make_sanitized_template, make_unanswered, sanitize_restored
from grader.storage.registering import register

RIGHT = 'def double(x):\n    return 2 * x'
SCRIPT = '<script>alert("from a student")</script>'


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('feedback'))


def feedback(course, student, notebook, *, reasons=None, outputs=None, notes=()):
    submit(course, student, notebook)
    folder = course.folder('submitted', student, TOY)
    submission = read_submission(folder, student_id=student, assignment=TOY)
    if submission.problem:
        graded = make_unanswered(make_sanitized_template(course, TOY), submission.problem)
    else:
        restored = restore(submission.notebook, course.template(TOY)).notebook
        graded = executed(sanitize_restored(course, TOY, restored), reasons or {})
        for cell in graded.cells:
            if cell.id in (outputs or {}):
                cell.outputs = [*outputs[cell.id], *cell.outputs]
            if cell.id == 'double-hidden':
                cell.metadata[KEY]['notes'] = list(notes)
    store(course, submission, graded)
    pages = write_feedback(course)
    place = course.folder('feedback', student, TOY) / f'{TOY}.html'
    assert place in pages
    return place.read_text()


def test_a_failed_check_shows_what_was_expected_and_seen_and_what_to_try(course):
    html = feedback(
        course,
        'ada',
        answered(course, RIGHT),
        reasons={'double-hidden': 'expected 42, saw E: 41: count again'},
        notes=['judged on the wall clock'],
    )
    assert '>Expected 42, saw E: 41.</td>' in html
    assert re.search(r'<td class="todo"[^>]*>Count again</td>', html)
    assert '<dt>Seen</dt><dd>E: 41</dd>' in html
    assert 'Other numbers are doubled too' in html
    assert 'Note: judged on the wall clock' in html
    assert '1 of 5 points' in html


STOPPED = 'your cell `double` stopped with NameError: no such thing'
UNDEFINED = {'double-hidden': 'expected a function `double`, saw none: define it'}


def test_the_error_of_a_cell_comes_first_if_points_are_missing(course):
    html = feedback(course, 'bea', answered(course, RIGHT), reasons=UNDEFINED, notes=[STOPPED])
    why = 'Your cell <code>double</code> stopped with NameError: no such thing'
    assert re.search(f'<td class="why"[^>]*>{why}</td>', html)
    assert 'Fix that first. What the check saw is shown below.' in html
    assert f'<p>{why}</p>' in html
    assert '<dt>Try</dt><dd class="next">Define it</dd>' in html
    assert 'Note: ' not in html


def test_the_error_of_a_cell_is_shown_in_the_students_language(course):
    notebook = answered(course, RIGHT)
    notebook.metadata[KEY] = {'language': 'zh_CN'}
    html = feedback(course, 'bea', notebook, reasons=UNDEFINED, notes=[STOPPED])
    assert html.count('你的单元格 <code>double</code> 停止了：NameError: no such thing') == 2


def test_what_is_missing_is_shown_in_the_students_language(course):
    notebook = answered(course, RIGHT)
    notebook.metadata[KEY] = {'language': 'zh_CN'}
    reason, _ = say_unanswered('double')
    html = feedback(course, 'bea', notebook, reasons={'double-hidden': reason})
    assert '预期：<code>double</code> 的答案；实际：还没有。' in html


def test_the_error_of_a_cell_is_only_a_note_if_no_points_are_missing(course):
    html = feedback(course, 'bea', answered(course, RIGHT), notes=[STOPPED])
    assert 'Note: your cell <code>double</code> stopped with NameError' in html
    assert 'Fix that first' not in html


@pytest.mark.parametrize(
    ('reason', 'shown'),
    [
        ('no such name: double', 'No such name: double'),
        ('double(2) is 5', 'double(2) is 5'),  # a name in the code keeps its small letter
    ],
)
def test_a_reason_that_does_not_begin_with_expected_is_shown_whole(course, reason, shown):
    html = feedback(course, 'ada', answered(course, RIGHT), reasons={'double-check': reason})
    assert re.search(f'<td class="why"[^>]*>{re.escape(shown)}</td>', html)


def test_the_title_of_a_check_fits_the_part_that_failed():
    """The first two predictions may be right, and others wrong."""
    cell = new_code_cell(
        '"""The first two are right"""\ncheck()',
        metadata={
            'nbgrader': {'grade': True, 'grade_id': 'a', 'points': 2, 'score': 1.0},
            KEY: {'role': 'grade', 'reason': '2 wrong', 'failed_at_grading': False},
        },
    )
    assert page_parts._check(cell).title == 'The first two are right'
    cell.metadata[KEY].failed_at_grading = True
    assert page_parts._check(cell).title == 'Checked at grading, beyond “The first two are right”'
    cell.source = '"""The others are right"""\nprint("checked at grading")'
    assert page_parts._check(cell).title == 'The others are right'


@pytest.mark.parametrize(
    ('text', 'shown'),
    {
        'degrees are not radians': 'Degrees are not radians',
        'a stamp of 0': 'A stamp of 0',
        'x and y are swapped': 'x and y are swapped',
        'x 和 y 颠倒了': 'x 和 y 颠倒了',
        'position 里有两个角度': 'position 里有两个角度',
    }.items(),
)
def test_a_sentence_begins_with_a_capital_letter_if_its_first_word_is_no_name(text, shown):
    assert page.capitalised(text) == shown


def test_advice_with_colons_is_separated_from_the_rest_of_a_reason():
    reason = 'expected {1: 2}, saw E: no: its thread raised E: no, so fix that first: it ended'
    hint = 'its thread raised E: no, so fix that first: it ended'
    assert page_parts._parts(reason, hint, 'en') == {
        'expected': '{1: 2}',
        'seen': 'E: no',
        'hint': hint,
    }


def test_a_failure_at_grading_is_tried_in_a_cell_of_ones_own(course):
    """The check in the lesson would only say once more that it is checked at grading."""
    said = new_output('stream', name='stdout', text='checked at grading\n')
    reasons = {'double-hidden': f'{PLACE}double(-1) has to be negative'}
    html = feedback(
        course,
        'ada',
        answered(course, RIGHT),
        reasons=reasons,
        outputs={'double-hidden': [said]},
    )
    assert 'does not test this: try it in a cell of your own.</td>' in html
    assert '<pre tabindex="0" class="text">checked at grading</pre>' not in html


def test_the_open_part_of_a_check_is_shown_and_its_hidden_test_is_not(course):
    html = feedback(course, 'ada', answered(course, RIGHT))
    graded = (course.folder('autograded', 'ada', TOY) / f'{TOY}.ipynb').read_text()
    assert 'canary' in graded
    assert 'canary' not in html
    assert 'HIDDEN' not in html
    assert 'The visible part of this check' in html


def test_a_traceback_that_quotes_a_test_is_not_shown(course):
    quoting = new_output(
        'error', ename='E', evalue='it failed', traceback=['assert hidden canary == 1']
    )
    html = feedback(course, 'ada', answered(course, RIGHT), outputs={'double-hidden': [quoting]})
    assert 'canary' not in html


def test_no_script_of_a_student_runs_on_a_page(course):
    outputs = [
        new_output('stream', text=SCRIPT),
        new_output('display_data', {'text/html': SCRIPT, 'text/plain': SCRIPT}),
        new_output('display_data', {'image/svg+xml': f'<svg>{SCRIPT}</svg>'}),
        new_output('display_data', {'application/javascript': 'alert(2)'}),
        new_output('display_data', {'image/png': f'"><script>{SCRIPT}'}),
        new_output('error', ename=SCRIPT, evalue=SCRIPT, traceback=[SCRIPT]),
    ]
    html = feedback(
        course,
        SCRIPT.replace('/', '\\'),
        answered(course, f'# {SCRIPT}', explained=f'[x](javascript:alert(1)) <b>so</b> {SCRIPT}'),
        reasons={'double-check': f'expected {SCRIPT}, saw {SCRIPT}: {SCRIPT}'},
        outputs={'double': outputs, 'try-it': outputs},
    )
    assert '<script' not in html
    assert 'href="javascript' not in html
    assert "default-src 'none'" in html


def test_invisible_and_direction_changing_characters_are_escaped_on_a_page(course):
    hidden = '\u202egnorw\u2066\u200b\x1b'
    notebook = answered(
        course,
        f'# {hidden} 王小明 محمد\n{RIGHT}',
        explained=f'{hidden} &#x202e; &#8238; &rlm; &amp; é 👩\u200d🔬 محمد',
    )
    html = feedback(
        course,
        'unseen',
        notebook,
        reasons={'double-check': f'expected 2, saw {hidden}: try {hidden}'},
        outputs={'double': [new_output('stream', text=f'printed {hidden}')]},
        notes=[f'noted {hidden}'],
    )
    page = unescape(html)
    assert not re.search('[\u200b\u200f\u202a-\u202e\u2066-\u2069\x1b]', page)
    assert page.count('\\u202egnorw\\u2066\\u200b') >= 6
    assert page.count('محمد') == 2
    assert '王小明' in page
    assert '& é 👩\u200d🔬 محمد' in page


def test_pictures_are_shown_and_described(course):
    picture = new_output('display_data', {'image/png': PIXEL, 'text/plain': '<Figure size 1x1>'})
    html = feedback(course, 'ada', answered(course, RIGHT), outputs={'double-hidden': [picture]})
    assert f'src="data:image/png;base64,{PIXEL}" alt="Picture of: Other numbers are' in html
    assert base64.b64decode(PIXEL).startswith(b'\x89PNG')


def test_an_unreadable_submission_has_a_page_with_its_reason(course):
    html = feedback(course, 'ada', b'{"cells": ')
    assert 'Your submission could not be read' in html
    assert 'could not be graded' not in html  # that is no zero, but no score at all
    assert 'is not JSON' in html
    assert '0 of 5 points' in html


def test_a_restored_cell_is_mentioned_on_the_page(course):
    notebook = answered(course, RIGHT)
    del notebook.cells[6]
    html = feedback(course, 'ada', notebook)
    assert 'the cell <code>double-check</code> was missing: it was put back' in html


def test_a_notebook_without_answer_cells_is_not_said_to_have_cost_no_points(course):
    notebook = answered(course, RIGHT)
    for cell in notebook.cells:  # as a program that removes what it does not know saves it
        cell.metadata = {}
    html = feedback(course, 'ada', notebook)
    top, _, restored = html.partition(
        'this cost no points, but an answer that was missing earns none'
    )
    assert 'Your answers were not found' in top
    assert 'The notebook holds none of the answer cells of this assignment: ' in top
    assert 'none of the answer cells' not in restored


def test_a_written_answer_waits_for_the_instructor_and_is_not_scored_zero(course):
    html = feedback(course, 'ada', answered(course, RIGHT, explained='It **is** so.'))
    assert '<strong>is</strong>' in html
    assert '– of 2' in html
    assert 'Your instructor will read this.' in html


def test_only_what_a_person_wrote_is_shown_as_a_comment(course):
    html = feedback(course, 'cyn', course.release(TOY))
    assert 'There is no answer' in html
    assert 'Comment:' not in html
    with open_database(course.db_url) as book:
        for name in ('double', 'explain'):
            book.find_comment(name, TOY, TOY, 'cyn').manual_comment = f'see {name}'
        book.db.commit()
    write_feedback(course)
    html = (course.folder('feedback', 'cyn', TOY) / f'{TOY}.html').read_text()
    assert re.findall('Comment:</strong> (.*?)</p>', html) == ['see double', 'see explain']


def test_writing_feedback_again_changes_no_page(course):
    feedback(course, 'ada', answered(course, RIGHT))
    said = []
    assert write_feedback(course, say=said.append)
    assert not said


def test_a_course_without_submissions_has_no_pages(tmp_path):
    assert write_feedback(Course.at(tmp_path)) == []


@pytest.mark.slow
def test_text_that_takes_too_long_to_convert_is_shown_as_typed(course, monkeypatch):
    """For each of these formulas, the converter searches the rest of the text for its end."""
    monkeypatch.setattr(module, 'LIMITS', Limits(cpu_sec=2))
    html = feedback(course, 'eve', answered(course, RIGHT, explained=r'<b>\begin{a}' * 40_000))
    assert 'Your text is shown as you typed it: it takes over 2 s of processor time' in html
    assert r'<pre>&lt;b&gt;\begin{a}' in html
    assert ' of 5 points' in html


def test_a_page_that_cannot_be_made_does_not_stop_other_pages(course, monkeypatch):
    def too_hard(function, notebook, about, *more, limits):
        if about['student'] == 'eve':
            raise ParsingFailed('it takes too much\x1b[2J memory')
        return parse(function, notebook, about, *more, limits=limits)

    for student in ('eve', 'zoe'):
        feedback(course, student, answered(course, RIGHT))
    monkeypatch.setattr(module, 'parse', too_hard)
    said = []
    pages = write_feedback(course, say=said.append)
    assert f'{TOY} of eve has no page of feedback: it takes too much\\x1b[2J memory' in said
    assert {page.parts[-3] for page in pages} >= {'zoe'}
    assert 'eve' not in {page.parts[-3] for page in pages}


def test_a_student_removed_from_the_database_is_reported_and_has_no_page(course):
    feedback(course, 'leaves', answered(course, RIGHT))
    with open_database(course.db_url) as book:
        book.remove_student('leaves')
    said = []
    pages = write_feedback(course, say=said.append)
    assert pages
    assert course.folder('feedback', 'leaves', TOY) / f'{TOY}.html' not in pages
    folder = course.folder('autograded', 'leaves', TOY)
    assert said == [
        f'{TOY} of leaves has no page of feedback: the database has no scores of it. ./course '
        'grade --student leaves grades it again; if it is not to count any more, remove '
        f'{folder}'
    ]
    shutil.rmtree(folder)


def test_files_that_nbgrader_needs_to_release_feedback_are_beside_the_page(course):
    """Its `release_feedback` reads both files, and stops if one is missing."""
    graded = course.folder('autograded', 'ada', TOY)
    feedback(course, 'ada', answered(course, RIGHT))
    for name, text in (
        ('timestamp.txt', '2026-01-01 10:00:00 UTC'),
        ('submission_secret.txt', 'aa'),
    ):
        (graded / name).write_text(text)
    (page,) = (each for each in write_feedback(course) if 'ada' in each.parts)
    assert (page.parent / 'timestamp.txt').read_text() == '2026-01-01 10:00:00 UTC'
    assert (page.parent / 'submission_secret.txt').read_text() == 'aa'


def test_many_pages_are_written_and_reported_in_order(course, tmp_path):
    course = Course(root=course.root, gradebook=tmp_path / 'gradebook')
    register(course, TOY)
    students = [f's{number:02}' for number in range(3 * AT_ONCE)]
    for student in students:
        submission = handed_in(course, student)
        store(course, submission, executed(make_sanitized_template(course, TOY).notebook, {}))
    told = []
    pages = write_feedback(course, say=told.append)
    assert [page.parts[-3] for page in pages] == students
    assert told == [str(page) for page in pages]
    whole = {page: page.read_bytes() for page in pages}
    assert all(f'{page.parts[-3]}'.encode() in html for page, html in whole.items())
    told.clear()
    assert write_feedback(course, say=told.append) == pages
    assert not told
    assert whole == {page: page.read_bytes() for page in pages}
    pages[1].unlink()
    damaged = course.folder('autograded', students[2], TOY) / f'{TOY}.ipynb'
    damaged.write_text('damaged')
    assert write_feedback(course, say=told.append) == pages[:2] + pages[3:]
    assert told == [
        str(pages[1]),
        f'{TOY} of {students[2]} has no page of feedback: the graded notebook {damaged} is '
        f'damaged: run ./course grade --student {students[2]}, which grades it again',
    ]
    assert pages[2].read_bytes() == whole[pages[2]]  # the page of the run before


def test_an_error_while_writing_a_page_names_the_page(course, tmp_path, monkeypatch):
    course = Course(root=course.root, gradebook=tmp_path / 'gradebook')
    register(course, TOY)
    submission = handed_in(course, 'ada')
    store(course, submission, executed(make_sanitized_template(course, TOY).notebook, {}))
    monkeypatch.setattr(module, 'graded_notebook', lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError) as raised:
        write_feedback(course)
    assert raised.value.__notes__ == [f'This was the page of ada for {TOY}.']


def test_an_interrupt_waits_for_no_page():
    with pytest.raises(KeyboardInterrupt), module._threads() as threads:  # noqa: PT012
        work = threads.submit(parse, 'time:sleep', 60, limits=Limits(wall_sec=20))
        later = [threads.submit(parse, 'os:getpid') for _ in range(5 * AT_ONCE)]
        while not parsing._SERVERS._busy:
            time.sleep(0.01)
        raise KeyboardInterrupt
    assert not isinstance(work.exception(), ParsingFailed)
    assert later[-1].cancelled()


def handed_in(course, student):
    submit(course, student, answered(course, RIGHT))
    folder = course.folder('submitted', student, TOY)
    return read_submission(folder, student_id=student, assignment=TOY)
