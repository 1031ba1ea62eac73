"""Who owns a collected file: platform numbers and names, and work under another's name."""

import json
import shutil
import zipfile

import nbformat
import pytest
from collected import NOTEBOOK, rows, submitted, write
from course_maker import TOY

from grader.collect.collect import AGAIN, KNOWN, LEFT, NEW, collect
from grader.common.errors import CourseError


def uploaded(came_in, who, number, content, inside=''):
    write(came_in / f'{who}_{number}_assignsubmission_file_{inside}/{NOTEBOOK}', content)


def numbers(course):
    return json.loads((course.gradebook / 'numbers.json').read_text())


def test_a_file_that_names_a_different_student_cannot_replace_that_student_s_work(course, came_in):
    uploaded(came_in, 'Ada Lovelace', 1815, 'hers')
    rows(course, came_in)
    uploaded(came_in, 'Mallory Evil', 666, 'forged', '/Ada Lovelace')
    write(came_in / f'Mallory Evil_666_assignsubmission_file_/Ada Lovelace_{TOY}.ipynb', 'forged')
    with zipfile.ZipFile(came_in / 'Mallory Evil_666_assignsubmission_file_/a.zip', 'w') as box:
        box.writestr(f'Lovelace, Ada/{NOTEBOOK}', 'forged')
    assert sorted(rows(course, came_in).values()) == [KNOWN, LEFT, LEFT, LEFT]
    assert submitted(course, 'Ada Lovelace') == {NOTEBOOK: 'hers'}
    assert [path.name for path in (course.gradebook / 'submitted').iterdir()] == ['Ada Lovelace']


def test_moodle_numbers_are_kept_and_a_namesake_is_left_to_the_instructor(
    course, came_in, tmp_path
):
    uploaded(came_in, 'Ada Lovelace', 1815, 'hers')
    uploaded(came_in, '王小明', 7, 'his')
    assert set(rows(course, came_in).values()) == {NEW}
    kept = {
        'Ada Lovelace': {TOY: {'moodle': '1815'}},
        '王小明': {TOY: {'moodle': '7'}},
    }
    assert numbers(course) == kept
    uploaded(tmp_path / 'later', 'Ada Lovelace', 1906, 'another’s')
    (row,) = collect(course, tmp_path / 'later')
    assert row.outcome == LEFT
    assert "the name Ada Lovelace has Moodle's number 1906 here and 1815 elsewhere" in row.reason
    assert submitted(course, 'Ada Lovelace') == {NOTEBOOK: 'hers'}
    (tmp_path / 'later/Ada Lovelace_1906_assignsubmission_file_').rename(
        tmp_path / 'later/Ada Lovelace'
    )
    assert set(rows(course, tmp_path / 'later').values()) == {AGAIN}
    assert numbers(course) == kept


def test_two_downloads_that_disagree_on_a_student_s_number_are_not_taken(course, came_in):
    for number, folder in ((1, 'monday'), (2, 'tuesday')):
        uploaded(came_in / folder, 'Ada Lovelace', number, folder)
    assert set(rows(course, came_in).values()) == {LEFT}
    assert not (course.gradebook / 'numbers.json').exists()


def test_canvas_submissions_are_matched_by_the_number_of_the_student(course, came_in):
    write(came_in / f'lovelaceada_18151_21012_{TOY}.ipynb', 'one')
    assert set(rows(course, came_in).values()) == {NEW}
    (came_in / f'lovelaceada_18151_21012_{TOY}.ipynb').unlink()
    write(came_in / f'lovelaceada_LATE_18151_21999_{TOY}-1.ipynb', 'two')
    assert set(rows(course, came_in).values()) == {AGAIN}
    write(came_in / f'lovelaceada_19061_22000_{TOY}.ipynb', 'another’s')
    assert set(rows(course, came_in).values()) == {LEFT}
    assert numbers(course) == {'lovelaceada': {TOY: {'canvas': '18151'}}}


@pytest.mark.parametrize('packed', [False, True])
def test_a_class_folder_that_looks_like_a_canvas_name_is_no_student(packed, course, came_in):
    folder = came_in / 'kurs_101_202'
    write(folder / 'ada' / NOTEBOOK, 'hers')
    write(folder / f'bob_{TOY}.ipynb', 'his')
    if packed:
        shutil.make_archive(str(folder), 'zip', came_in, folder.name)
        folder = folder.with_suffix('.zip')
    assert set(rows(course, folder).values()) == {NEW}
    assert [submitted(course, who)[NOTEBOOK] for who in ('ada', 'bob')] == ['hers', 'his']
    assert not course.folder('submitted', 'kurs', TOY).exists()


def test_blackboard_submissions_are_ordered_by_time_without_numbers(course, came_in):
    attempt = f'Lab 1_{{}}_attempt_2026-01-0{{}}-10-00-00_{TOY}.ipynb'
    write(came_in / attempt.format('ada', 2), 'first')
    write(came_in / attempt.format('ada', 3), 'second')
    write(came_in / attempt.format('bob', 2), 'his')
    assert sorted(rows(course, came_in).values()) == [AGAIN, NEW, NEW]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert submitted(course, 'bob')[NOTEBOOK] == 'his'
    assert not (course.gradebook / 'numbers.json').exists()
    assert sorted(rows(course, came_in).values()) == [KNOWN, KNOWN, KNOWN]
    write(came_in / 'later' / attempt.replace('Lab 1', 'Lab 1 again').format('ada', 4), 'third')
    assert set(rows(course, came_in / 'later').values()) == {AGAIN}


@pytest.mark.parametrize('damage', ['{', '[]', '{"ada": 1}', '{"ada": {"x": {"moodle": 1}}}'])
def test_a_damaged_file_of_numbers_is_reported_in_a_sentence(damage, course, came_in):
    write(course.gradebook / 'numbers.json', damage)
    uploaded(came_in, 'Ada', 1, '')
    with pytest.raises(CourseError, match='is damaged: restore it from a backup, or remove it'):
        rows(course, came_in)


def test_a_folder_inside_an_upload_is_mentioned_beside_the_taken_file(course, came_in):
    uploaded(came_in, 'Ada', 1, 'hers', '/turtles')
    (row,) = collect(course, came_in)
    assert (row.outcome, row.reason) == (NEW, "from a folder of their own, 'turtles'")


def test_different_spellings_of_a_student_s_name_are_reported(course, came_in):
    for name in 'Ada Lovelace', 'ADA_lovelace', 'Ada_Lovelace':
        write(course.folder('submitted', name, '99_other') / '99_other.ipynb', '{}')
    write(came_in / f'ada_lovelace_{TOY}.ipynb', nbformat.writes(course.release(TOY)))
    write(came_in / f'bob_{TOY}.ipynb', nbformat.writes(course.release(TOY)))
    first, second = collect(course, came_in)
    assert first.student_id == 'ada_lovelace'
    others = 'ADA_lovelace, Ada Lovelace, Ada_Lovelace'
    assert first.reason == f'not the same as {others}: if it is, rename one'
    assert second.reason == ''
