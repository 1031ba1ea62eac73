"""Submissions are put where they are graded, and earlier files there are kept."""

import csv
from datetime import datetime
from pathlib import Path

import nbformat
import pytest
from collected import NOTEBOOK, rows, submitted, tree, write
from course_maker import TOY, answered, executed
from nbgrader.coursedir import CourseDirectory

from grader.__main__ import main
from grader.collect.collect import AGAIN, EARLIER, KNOWN, LEFT, NEW, UNUSED, collect
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.storage.gradebook import store
from grader.storage.pipeline import sanitize_restored
from grader.storage.registering import register
from grader.storage.submitted import find_submissions

RIGHT, WRONG = 'def double(x):\n    return 2 * x', 'def double(x):\n    return x'


def before(course, student='ada'):
    return tree(course.folder('submitted_before', student, TOY))


def exchanged(came_in, day, content):
    folder = came_in / f'ada+{TOY}+2026-01-0{day} 10:00:00.000000 UTC'
    write(folder / NOTEBOOK, content)
    write(folder / 'timestamp.txt', f'2026-01-0{day} 10:00:00.000000 UTC')


def test_collected_files_are_put_where_they_are_graded(course, came_in):
    write(came_in / f'ada_{TOY}.ipynb', 'ada’s')
    write(came_in / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    write(came_in / f'bob/{TOY}/helper.py', 'x = 1')
    write(came_in / f'bob/{TOY}/timestamp.txt', '2026-01-01 12:00:00 CET')
    write(came_in / 'whose.ipynb', '')
    write(came_in / 'notes.txt', '')
    untouched = tree(came_in)
    assert rows(course, came_in) == {
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
    assert tree(came_in) == untouched
    assert [each.problem for each in find_submissions(course)] == ['', '']


def test_collecting_again_changes_nothing(course, came_in):
    for day in (1, 2, 3):
        exchanged(came_in, day, f'version {day}')
    write(came_in / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    assert set(rows(course, came_in).values()) == {NEW, AGAIN}
    first = tree(course.gradebook)
    assert submitted(course)[NOTEBOOK] == 'version 3'
    assert [before(course)[f'{n}/submitted/{NOTEBOOK}'] for n in (1, 2)] == [
        'version 1',
        'version 2',
    ]
    for _ in range(2):
        assert set(rows(course, came_in).values()) == {KNOWN}
        assert tree(course.gradebook) == first


def test_a_course_of_ilias_that_was_collected_under_longer_names_keeps_them(
    course, came_in, capsys
):
    whole = 'Lovelace_Ada_ada_4711'
    write(course.folder('submitted', whole, TOY) / NOTEBOOK, 'first')
    write(came_in / whole / NOTEBOOK, 'second')
    assert main(['collect', str(came_in)], course=course) == 0
    (row,) = (line for line in capsys.readouterr().out.splitlines() if whole in line)
    assert 'kept in gradebook/submitted_before/' in row
    assert 'keeps it; a new student would be Lovelace_Ada' in row
    assert submitted(course, whole) == {NOTEBOOK: 'second'}
    assert before(course, whole) == {f'1/submitted/{NOTEBOOK}': 'first'}
    assert [folder.name for folder in course.folder('submitted', '', '').iterdir()] == [whole]


def test_a_later_submission_counts_and_the_earlier_one_is_kept_with_its_time(course, came_in):
    exchanged(came_in, 1, 'first')
    rows(course, came_in)
    exchanged(came_in, 2, 'second')
    assert sorted(rows(course, came_in).values()) == [AGAIN, KNOWN]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert submitted(course)['timestamp.txt'].startswith('2026-01-02')
    assert before(course) == {
        f'1/submitted/{NOTEBOOK}': 'first',
        '1/submitted/timestamp.txt': '2026-01-01 10:00:00.000000 UTC',
    }


def test_an_earlier_submission_that_is_collected_late_is_kept_and_does_not_count(
    course, came_in, tmp_path
):
    exchanged(came_in, 2, 'second')
    rows(course, came_in)
    exchanged(tmp_path / 'mail', 1, 'first')
    assert list(rows(course, tmp_path / 'mail').values()) == [EARLIER]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert before(course)[f'1/submitted/{NOTEBOOK}'] == 'first'
    assert list(rows(course, tmp_path / 'mail').values()) == [KNOWN]


def test_submissions_without_times_count_in_the_order_of_collecting(course, came_in):
    for version in ('one', 'two'):
        write(came_in / f'ada_{TOY}.ipynb', version)
        rows(course, came_in)
    assert submitted(course) == {NOTEBOOK: 'two'}
    assert before(course) == {f'1/submitted/{NOTEBOOK}': 'one'}
    write(came_in / f'ada_{TOY}.ipynb', 'one')
    (row,) = collect(course, came_in)
    assert row.outcome == KNOWN
    place = course.folder('submitted', 'ada', TOY)
    assert f'move gradebook/{place.relative_to(course.gradebook)} away and collect' in row.reason
    assert submitted(course) == {NOTEBOOK: 'two'}
    place.rename(came_in.with_name('moved away'))  # as the row says
    assert rows(course, came_in) == {f'ada_{TOY}.ipynb': NEW}
    assert submitted(course) == {NOTEBOOK: 'one'}


def test_an_empty_file_is_named_and_the_submission_before_it_is_kept(course, came_in):
    write(came_in / f'ada_{TOY}.ipynb', 'work')
    rows(course, came_in)
    write(came_in / f'ada_{TOY}.ipynb', '')
    (row,) = collect(course, came_in)
    assert row.outcome == AGAIN
    assert 'are kept in gradebook/submitted_before/ada/' in row.reason
    assert row.reason.endswith('; its file is empty: get it once more, or ask for it')
    assert before(course) == {f'1/submitted/{NOTEBOOK}': 'work'}


def test_a_former_version_that_is_submitted_again_later_is_graded(course, came_in):
    for day, content in ((1, 'good'), (2, 'bad'), (3, 'good')):
        exchanged(came_in, day, content)
        rows(course, came_in)
    assert submitted(course)[NOTEBOOK] == 'good'
    assert before(course)[f'2/submitted/{NOTEBOOK}'] == 'bad'


def test_a_changed_helper_file_makes_a_new_submission(course, came_in):
    write(came_in / f'ada/{NOTEBOOK}', 'same')
    rows(course, came_in)
    write(came_in / 'ada/helper.py', 'x = 1')
    assert rows(course, came_in) == {f'ada/{NOTEBOOK}': AGAIN}


def test_an_earlier_submission_keeps_its_grade(course, came_in):
    write(came_in / f'ada_{TOY}.ipynb', '')
    for answer, reasons in ((WRONG, {'double-check': 'expected 2, saw 1'}), (RIGHT, {})):
        notebook = answered(course, answer)
        (came_in / f'ada_{TOY}.ipynb').write_text(nbformat.writes(notebook))
        rows(course, came_in)
        register(course, TOY)
        folder = course.folder('submitted', 'ada', TOY)
        submission = read_submission(folder, student_id='ada', assignment=TOY)
        restored = restore(submission.notebook, course.template(TOY)).notebook
        store(course, submission, executed(sanitize_restored(course, TOY, restored), reasons))
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
def test_collecting_again_after_an_interrupted_run_loses_nothing(
    survived, course, came_in, monkeypatch
):
    for day in (1, 2):
        exchanged(came_in, day, f'version {day}')
    rename, calls = Path.rename, []

    def dies(path, target):
        calls.append(path)
        if len(calls) > survived:
            raise KeyboardInterrupt
        return rename(path, target)

    monkeypatch.setattr(Path, 'rename', dies)
    if survived < 4:  # new, one to the shelf, two to replace it
        with pytest.raises(KeyboardInterrupt):
            rows(course, came_in)
    else:
        rows(course, came_in)
    monkeypatch.undo()
    rows(course, came_in)
    assert submitted(course)[NOTEBOOK] == 'version 2'
    kept = {path: text for path, text in before(course).items() if path.endswith('.ipynb')}
    assert kept == {f'1/submitted/{NOTEBOOK}': 'version 1'}
    assert not list(course.gradebook.rglob('.new-*'))


def test_nbgrader_reads_the_time_of_a_collected_submission(course, came_in):
    exchanged(came_in, 1, '{}')
    rows(course, came_in)
    folder = course.folder('submitted', 'ada', TOY)
    assert CourseDirectory().get_existing_timestamp(str(folder)) == datetime(2026, 1, 1, 10)
