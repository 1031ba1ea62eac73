"""What was handed in lies where it is graded, and what was there before is kept."""

import csv
from datetime import datetime
from pathlib import Path

import nbformat
import pytest
from collected import NOTEBOOK, rows, submitted, tree, write
from course_maker import TOY, answered, executed, released_course
from nbgrader.coursedir import CourseDirectory

from grader.collect.collect import AGAIN, EARLIER, KNOWN, LEFT, NEW, UNUSED
from grader.course import Course
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.storage.gradebook import store
from grader.storage.pipeline import prepare
from grader.storage.registering import register
from grader.storage.submitted import find_submissions

RIGHT, WRONG = 'def double(x):\n    return 2 * x', 'def double(x):\n    return x'


@pytest.fixture(scope='module')
def released(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('collect'))


@pytest.fixture
def course(released, tmp_path):
    return Course(root=released.root, gradebook=tmp_path / 'gradebook')


@pytest.fixture
def source(tmp_path):
    folder = tmp_path / 'came in'
    folder.mkdir()
    return folder


def before(course, student='ada'):
    return tree(course.folder('submitted_before', student, TOY))


def exchanged(source, day, content):
    folder = source / f'ada+{TOY}+2026-01-0{day} 10:00:00.000000 UTC'
    write(folder / NOTEBOOK, content)
    write(folder / 'timestamp.txt', f'2026-01-0{day} 10:00:00.000000 UTC')


def test_what_came_in_lies_where_it_is_graded(course, source):
    write(source / f'ada_{TOY}.ipynb', 'ada’s')
    write(source / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    write(source / f'bob/{TOY}/helper.py', 'x = 1')
    write(source / f'bob/{TOY}/timestamp.txt', '2026-01-01 12:00:00 CET')
    write(source / 'whose.ipynb', '')
    write(source / 'notes.txt', '')
    untouched = tree(source)
    assert rows(course, source) == {
        f'ada_{TOY}.ipynb': NEW,
        f'bob/{TOY}/{NOTEBOOK}': NEW,
        'whose.ipynb': LEFT,
        'notes.txt': UNUSED,
    }
    assert submitted(course) == {NOTEBOOK: 'ada’s'}
    assert submitted(course, 'bob') == {
        NOTEBOOK: 'bob’s',
        'helper.py': 'x = 1',
        'timestamp.txt': '2026-01-01 11:00:00.000000 UTC',
    }
    assert tree(source) == untouched
    assert [each.problem for each in find_submissions(course)] == ['', '']


def test_doing_it_again_changes_nothing(course, source):
    for day in (1, 2, 3):
        exchanged(source, day, f'version {day}')
    write(source / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    assert set(rows(course, source).values()) == {NEW, AGAIN}
    first = tree(course.gradebook)
    assert submitted(course)[NOTEBOOK] == 'version 3'
    assert [before(course)[f'{n}/submitted/{NOTEBOOK}'] for n in (1, 2)] == [
        'version 1',
        'version 2',
    ]
    for _ in range(2):
        assert set(rows(course, source).values()) == {KNOWN}
        assert tree(course.gradebook) == first


def test_a_later_one_counts_and_the_earlier_is_kept_with_its_time(course, source):
    exchanged(source, 1, 'first')
    rows(course, source)
    exchanged(source, 2, 'second')
    assert sorted(rows(course, source).values()) == [AGAIN, KNOWN]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert submitted(course)['timestamp.txt'].startswith('2026-01-02')
    assert before(course) == {
        f'1/submitted/{NOTEBOOK}': 'first',
        '1/submitted/timestamp.txt': '2026-01-01 10:00:00.000000 UTC',
    }


def test_an_earlier_one_that_comes_late_is_kept_and_does_not_count(course, source, tmp_path):
    exchanged(source, 2, 'second')
    rows(course, source)
    exchanged(tmp_path / 'mail', 1, 'first')
    assert list(rows(course, tmp_path / 'mail').values()) == [EARLIER]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert before(course)[f'1/submitted/{NOTEBOOK}'] == 'first'
    assert list(rows(course, tmp_path / 'mail').values()) == [KNOWN]


def test_without_times_what_comes_later_is_later(course, source):
    for version in ('one', 'two'):
        write(source / f'ada_{TOY}.ipynb', version)
        rows(course, source)
    assert submitted(course) == {NOTEBOOK: 'two'}
    assert before(course) == {f'1/submitted/{NOTEBOOK}': 'one'}
    write(source / f'ada_{TOY}.ipynb', 'one')
    assert rows(course, source) == {f'ada_{TOY}.ipynb': KNOWN}
    assert submitted(course) == {NOTEBOOK: 'two'}


def test_who_goes_back_to_a_former_version_later_is_graded_by_it(course, source):
    for day, content in ((1, 'good'), (2, 'bad'), (3, 'good')):
        exchanged(source, day, content)
        rows(course, source)
    assert submitted(course)[NOTEBOOK] == 'good'
    assert before(course)[f'2/submitted/{NOTEBOOK}'] == 'bad'


def test_a_changed_helper_is_another_submission(course, source):
    write(source / f'ada/{NOTEBOOK}', 'same')
    rows(course, source)
    write(source / 'ada/helper.py', 'x = 1')
    assert rows(course, source) == {f'ada/{NOTEBOOK}': AGAIN}


def test_the_earlier_one_keeps_its_grade(course, source):
    write(source / f'ada_{TOY}.ipynb', '')
    for answer, reasons in ((WRONG, {'double-check': 'expected 2, saw 1'}), (RIGHT, {})):
        notebook = answered(course, answer)
        (source / f'ada_{TOY}.ipynb').write_text(nbformat.writes(notebook))
        rows(course, source)
        register(course, TOY)
        folder = course.folder('submitted', 'ada', TOY)
        submission = read_submission(folder, student_id='ada', assignment=TOY)
        restored = restore(submission.notebook, course.template(TOY)).notebook
        store(course, submission, executed(prepare(course, TOY, restored), reasons))
    kept = course.folder('submitted_before', 'ada', TOY) / '1'
    assert sorted(path.name for path in kept.iterdir()) == [
        'autograded',
        'scores.csv',
        'submitted',
    ]
    table = {
        row['grade_id']: row
        for row in csv.DictReader((kept / 'scores.csv').open(encoding='utf-8-sig'))
    }
    assert (table['double-check']['score'], table['double-hidden']['score']) == ('0.0', '2.0')
    assert table['double-check']['comment'] == 'expected 2, saw 1'
    assert WRONG.splitlines()[1].strip() in (kept / 'autograded' / NOTEBOOK).read_text()


@pytest.mark.parametrize('survived', range(5))
def test_a_run_that_ended_half_way_loses_nothing_and_goes_on(
    survived, course, source, monkeypatch
):
    for day in (1, 2):
        exchanged(source, day, f'version {day}')
    rename, calls = Path.rename, []

    def dies(path, target):
        calls.append(path)
        if len(calls) > survived:
            raise KeyboardInterrupt
        return rename(path, target)

    monkeypatch.setattr(Path, 'rename', dies)
    if survived < 4:  # new, one to the shelf, two to replace it
        with pytest.raises(KeyboardInterrupt):
            rows(course, source)
    else:
        rows(course, source)
    monkeypatch.undo()
    rows(course, source)
    assert submitted(course)[NOTEBOOK] == 'version 2'
    kept = {path: text for path, text in before(course).items() if path.endswith('.ipynb')}
    assert kept == {f'1/submitted/{NOTEBOOK}': 'version 1'}
    assert not list(course.gradebook.rglob('.new-*'))


def test_nbgrader_reads_the_time(course, source):
    exchanged(source, 1, '{}')
    rows(course, source)
    folder = course.folder('submitted', 'ada', TOY)
    assert CourseDirectory().get_existing_timestamp(str(folder)) == datetime(2026, 1, 1, 10)
