"""`./course collect`: what it prints, and which folders it takes."""

import os
import time
from datetime import UTC, datetime

import nbformat
import pytest
from collected import write
from course_maker import TOY

from grader.__main__ import main
from grader.collect.collect import NEW, collect
from grader.common.dates import date_of
from grader.common.errors import CourseError
from grader.course import Course
from grader.notebook.submission import TIMESTAMP


def test_collect_prints_rows_of_files_and_exits_with_1_if_one_was_not_taken(
    course, came_in, capsys
):
    write(came_in / f'小明_{TOY}.ipynb', 'x')
    os.utime(came_in / f'小明_{TOY}.ipynb', (1_700_000_000, 1_700_000_000))
    assert main(['collect', str(came_in), '--file-times'], course=course) == 0
    assert capsys.readouterr().out.splitlines() == [
        'student  assignment  handed in (UTC)',
        '小明     00_toy      2023-11-14 22:13:20  new',
        '',
        '1 new; 0 not taken.',
        'Next: ./course grade',
    ]
    write(came_in / '\x1b[31mred.ipynb', '')
    for number in range(5):
        write(came_in / f'photos/{number}.png', '')
    assert main(['collect', str(came_in)], course=course) == 1
    out = capsys.readouterr().out
    assert '\x1b' not in out
    assert '\\x1b[31mred.ipynb  named after no assignment: expected STUDENT_ASSIGNMENT' in out
    assert 'photos/0.png and 4 more  neither a notebook nor Python' in out
    assert out.splitlines()[-2:] == ['1 there already; 1 not taken.', 'Next: ./course grade']


def test_the_next_step_is_printed_only_if_something_was_taken(course, came_in, capsys):
    for number, status, last in ((1, 0, 'Next: ./course grade'), (2, 1, None)):
        folder = came_in / str(number)
        write(folder / f'Ada_{number}_assignsubmission_file_/{TOY}.ipynb', '')
        assert main(['collect', str(folder)], course=course) == status
        assert capsys.readouterr().out.splitlines()[-1] == (
            last or 'Nothing was taken; 1 not taken.'
        )


def test_a_time_that_was_not_known_before_is_added_and_a_known_one_stays(course, came_in, capsys):
    paper = came_in / f'ada_{TOY}.ipynb'
    write(paper, 'x')
    stamp = course.folder('submitted', 'ada', TOY) / TIMESTAMP
    said = []
    for seconds, options in (
        (1_700_000_000, []),
        (1_700_000_000, ['--file-times']),
        (1_700_000_000, ['--file-times']),
        (1_700_009_000, ['--file-times']),
        (1_700_009_000, []),
    ):
        os.utime(paper, (seconds, seconds))
        assert main(['collect', str(came_in), *options], course=course) == 0
        said.append(capsys.readouterr().out.splitlines()[1].split('  ')[-1])
    assert said == [
        'new',
        'there already: when it was handed in was not known before',
        'there already: nothing new',
        *['there already: the time that counts is 2023-11-14 22:13:20'] * 2,
    ]
    assert date_of(stamp) == datetime(2023, 11, 14, 22, 13, 20, tzinfo=UTC)


def test_the_same_files_handed_in_later_do_not_become_late(course, came_in, capsys):
    paper = came_in / f'ada_{TOY}.ipynb'
    write(paper, 'x')
    assert main(['collect', str(came_in)], course=course) == 0
    later = time.time() + 90_000.0
    os.utime(paper, (later, later))
    capsys.readouterr()
    assert main(['collect', str(came_in), '--file-times'], course=course) == 0
    assert 'there already: taken in before that, on ' in capsys.readouterr().out
    assert not (course.folder('submitted', 'ada', TOY) / TIMESTAMP).exists()


def test_a_missing_or_empty_folder_to_collect_is_reported(course, tmp_path, capsys):
    assert main(['collect', str(tmp_path / 'nowhere')], course=course) == 1
    assert 'nowhere is not there: expected a folder' in capsys.readouterr().err
    (tmp_path / 'empty').mkdir()
    assert main(['collect', str(tmp_path / 'empty')], course=course) == 1
    assert capsys.readouterr().out == (
        f'Nothing was taken: there is no file in {tmp_path / "empty"}. Expected what '
        'students handed in: name another folder or archive, or download it again\n'
    )


def test_a_report_of_unused_files_alone_begins_without_a_blank_line(course, tmp_path, capsys):
    (tmp_path / 'litter').mkdir()
    (tmp_path / 'litter' / '.DS_Store').write_text('')
    assert main(['collect', str(tmp_path / 'litter')], course=course) == 1
    assert capsys.readouterr().out.splitlines() == [
        'Not used for grading:',
        'file       reason',
        '.DS_Store  hidden, or left behind by a program',
        '',
        'Nothing was taken; 0 not taken.',
    ]


@pytest.mark.parametrize('place', ['.', '..', 'notebooks', 'notebooks/zh_CN', 'solutions'])
def test_the_lessons_of_the_course_are_refused_as_submissions(course, place, monkeypatch, capsys):
    came_in = course.root / place
    came_in.mkdir(exist_ok=True)
    monkeypatch.chdir(came_in)
    assert main(['collect', '.'], course=course) == 1
    said = capsys.readouterr().err
    assert f"{came_in.resolve()} holds the course's own lessons: expected a folder with" in said
    assert not course.folder('submitted', '', '').exists()


def test_lessons_are_recognized_behind_a_link_and_a_folder_beside_them_is_collected(
    course, tmp_path
):
    link = tmp_path / 'link'
    link.symlink_to(course.root)
    behind_link = Course(root=link, gradebook=course.gradebook)
    for place in link, course.root:
        with pytest.raises(CourseError, match="holds the course's own lessons"):
            list(collect(behind_link, place))
    beside = course.root / 'came in'
    write(beside / f'ada_{TOY}.ipynb', nbformat.writes(course.release(TOY)))
    assert [row.outcome for row in collect(behind_link, beside)] == [NEW]
