"""The ordinary events of a term, from submissions to feedback, only with the commands."""

import csv
import json
import re
import shutil
import zipfile

import nbformat
import pytest
from course_maker import TOY, answered, executed, make_course, toy_lesson, write_source
from nbgrader.api import Gradebook
from stand_in import stand_in

from grader.__main__ import main
from grader.authoring.release import release
from grader.course import Course
from grader.judging.execute import Execution
from grader.notebook.restore import grade_id
from grader.storage import reuse
from grader.storage.deadlines import FILE
from grader.storage.registering import register

OTHER = '01_other'
RIGHT = 'def double(x):\n    return 2 * x'
SLOPPY = 'def double(x):\n    return 2.0 * x'
WRONG = 'def double(x):\n    return x + 1'
TOO_STRICT = '# no floats'
HANDED_IN = {'ada': '2026-01-10 10:00:00 UTC', 'bob': '2026-01-12 10:00:00 UTC'}
HANDED_IN |= {'eve': '2026-01-10 11:00:00 UTC'}
LATE = f'[due]\n{TOY} = 2026-01-10T23:59:00Z\n[late]\nper_day = 0.2\n'
EXTENDED = f'{LATE}[extended.{TOY}]\nbob = 2026-01-12T23:59:00Z\n'


@pytest.fixture
def run_now():
    """The lessons of which an answer was run, in their order."""
    return []


@pytest.fixture(scope='module')
def released(tmp_path_factory):
    """Two lessons, the first with a check that is too strict."""
    course = make_course(tmp_path_factory.mktemp('term'))
    write_first_lesson(course, strict=True)
    other = toy_lesson()
    other.metadata['lesson'] = OTHER
    course.source_path(OTHER).parent.mkdir()
    nbformat.write(other, course.source_path(OTHER))
    release(course)
    for lesson in (TOY, OTHER):
        register(course, lesson)
    return course


@pytest.fixture
def course(released, tmp_path, monkeypatch, run_now):
    """A course for each test; answers are judged by their text and not run in rooms."""

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        by_id = {grade_id(cell): cell for cell in notebook.cells if grade_id(cell)}
        answer = by_id['double'].source
        strict = TOO_STRICT in by_id['double-hidden'].source
        run_now.append(notebook.metadata.get('lesson', TOY))
        hidden = '2.0' if strict else 'x + 1'
        reasons = {
            'double-check': 'count again' if 'x + 1' in answer else '',
            'double-hidden': 'no whole number' if hidden in answer else '',
        }
        return Execution(notebook=executed(notebook, reasons), verdicts=(), notes=())

    stand_in(look, monkeypatch)
    monkeypatch.setattr(reuse, 'software_hash', lambda: 'the same code')  # hashing it takes long
    shutil.copytree(released.root, tmp_path / 'course')
    return Course.at(tmp_path / 'course')


def write_first_lesson(course, *, strict):
    lesson = toy_lesson()
    if strict:
        [cell] = [cell for cell in lesson.cells if grade_id(cell) == 'double-hidden']
        cell.source += f'\n{TOO_STRICT}'
    write_source(course, lesson)


def collect(course, tmp_path):
    """Hand in what students answered, with times, as an archive of nbgrader's exchange."""
    with zipfile.ZipFile(tmp_path / 'class.zip', 'w') as archive:
        for student, answer in (('ada', RIGHT), ('bob', SLOPPY), ('eve', WRONG)):
            notebook = answered(course, answer, explained='Because it is twice.')
            for lesson in (TOY, OTHER):
                folder = f'{student}+{lesson}+{HANDED_IN[student].replace(":", "_")}'
                archive.writestr(f'{folder}/{lesson}.ipynb', nbformat.writes(notebook))
    assert main(['collect', str(tmp_path / 'class.zip')], course=course) == 0


def said(capsys, course, *arguments):
    capsys.readouterr()
    assert main(list(arguments), course=course) == 0
    return capsys.readouterr().out


def scores(course):
    """Score and comment by student and graded cell of the first lesson, as exported."""
    assert main(['scores'], course=course) == 0
    with (course.gradebook / 'scores.csv').open(encoding='utf-8-sig', newline='') as file:
        rows = [row for row in csv.DictReader(file) if row['assignment'] == TOY]
    return {(row['student_id'], row['grade_id']): (row['score'], row['comment']) for row in rows}


def changed(out):
    return re.findall(r'^  (\w+  \w+  .+ → .+)$', out, re.MULTILINE)


@pytest.mark.slow
def test_a_check_can_be_fixed_after_the_class_was_graded(course, tmp_path, capsys, run_now):
    collect(course, tmp_path)
    said(capsys, course, 'grade')
    assert run_now.count(TOY) == run_now.count(OTHER) == 3
    with Gradebook(course.db_url) as book:  # what a person writes into the formgrader
        grade = book.find_grade('explain', TOY, TOY, 'bob')
        grade.manual_score, grade.needs_manual_grade = 1.5, False
        book.find_comment('explain', TOY, TOY, 'bob').manual_comment = 'Twice of what?'
        book.db.commit()
    before = scores(course)
    assert before['bob', 'double-hidden'] == ('0.0', 'no whole number')

    write_first_lesson(course, strict=False)
    assert main(['release', TOY], course=course) == 0
    run_now.clear()
    out = said(capsys, course, 'grade')
    assert run_now == [TOY] * 3
    assert len(re.findall(rf'^\w+ +{OTHER} .*\(unchanged\)', out, re.MULTILINE)) == 3
    assert changed(out) == [
        f'bob  {TOY}  2.5 → 4.5 (+2)',
        f'eve  {TOY}  2 → 0 (-2)',
    ]
    now = scores(course)
    assert {each for each in now if now[each] != before[each]} == {
        ('bob', 'double-hidden'),
        ('eve', 'double-hidden'),
    }
    assert now['bob', 'explain'] == ('1.5', 'scored by hand; Twice of what?')
    report = json.loads(sorted(course.gradebook.glob('runs/*/report.json'))[-1].read_text())
    assert report['changes'] == changed(out)
    assert changed(said(capsys, course, 'grade')) == []


@pytest.mark.slow
def test_an_extension_removes_a_late_penalty_and_runs_no_answer(course, tmp_path, capsys, run_now):
    collect(course, tmp_path)
    (course.gradebook / FILE).write_text(LATE)
    said(capsys, course, 'grade')
    assert scores(course)['bob', 'late_penalty'] == ('-0.4', '')
    assert ('ada', 'late_penalty') not in scores(course)

    run_now.clear()
    (course.gradebook / FILE).write_text(EXTENDED)
    out = said(capsys, course, 'grade')
    assert run_now == []
    assert changed(out) == [f'bob  {TOY}  0.6 → 1 (+0.4)']
    assert ('bob', 'late_penalty') not in scores(course)
    assert changed(said(capsys, course, 'grade')) == []


@pytest.mark.slow
def test_the_earlier_grade_is_kept_aside_after_a_late_second_submission(course, tmp_path, capsys):
    collect(course, tmp_path)
    said(capsys, course, 'grade')
    with zipfile.ZipFile(tmp_path / 'again.zip', 'w') as archive:
        better = nbformat.writes(answered(course, RIGHT, explained='Twice.'))
        archive.writestr(f'eve+{TOY}+2026-01-12 10_00_00 UTC/{TOY}.ipynb', better)
    out = said(capsys, course, 'collect', str(tmp_path / 'again.zip'))
    assert 'handed in again' in out
    (course.gradebook / FILE).write_text(LATE)
    out = said(capsys, course, 'grade')
    assert f'eve  {TOY}' in ' '.join(changed(out))
    kept = course.folder('submitted_before', 'eve', TOY) / '1'
    assert 'count again' in (kept / 'scores.csv').read_text(encoding='utf-8')
