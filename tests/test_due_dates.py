import contextlib
import os
import time
from datetime import UTC, datetime, timedelta, timezone

import pytest
from course_maker import TOY, make_course

from grader.__main__ import main
from grader.common.argument_values import local_time
from grader.storage import due_dates
from grader.storage.deadlines import FILE, deadlines


@pytest.fixture
def course(tmp_path, monkeypatch):
    monkeypatch.setenv('TZ', 'Asia/Shanghai')
    time.tzset()
    yield make_course(tmp_path)
    monkeypatch.undo()
    time.tzset()


def due(course, *arguments):
    return main(['due', *arguments], course=course)


@pytest.mark.parametrize(
    ('text', 'hour', 'offset_hours'),
    [
        ('2026-11-30', (23, 59, 59), 8),
        ('20261130', (23, 59, 59), 8),
        ('2026-11-30 18:00', (18, 0), 8),
        ('2026-11-30T18:00', (18, 0), 8),
        ('2026-11-30T18:00+01:00', (18, 0), 1),
    ],
)
def test_a_date_means_the_end_of_the_day_and_times_are_local_by_default(
    course, text, hour, offset_hours
):
    zone = timezone(timedelta(hours=offset_hours))
    assert local_time(text) == datetime(2026, 11, 30, *hour, tzinfo=zone)


@pytest.mark.parametrize(
    ('text', 'utc'),
    [
        ('2026-03-29 02:30', (3, 29, 1, 30)),  # no clock shows it: 02:30 CET is 03:30 CEST
        ('2026-10-25 02:30', (10, 25, 1, 30)),  # it comes twice
        ('2026-10-25 02:30+02:00', (10, 25, 0, 30)),
        ('2026-10-25', (10, 25, 22, 59, 59)),
    ],
)
def test_an_ambiguous_time_at_a_clock_change_is_the_later_one(course, monkeypatch, text, utc):
    monkeypatch.setenv('TZ', 'Europe/Berlin')
    time.tzset()
    assert local_time(text) == datetime(2026, *utc, tzinfo=UTC)


def test_a_due_date_and_an_extension_can_be_set_and_removed(course, capsys):
    assert due(course, TOY, '2026-11-30') == 0
    assert due(course, TOY, '--student', '小明 O"Neil', '2026-12-03 12:00') == 0
    said = capsys.readouterr().out
    assert f'{TOY}  due 2026-11-30 23:59 CST' in said
    assert '  extended for 小明 O"Neil until 2026-12-03 12:00 CST' in said
    assert 'who has not handed it in yet: check that the name is right' in said
    found = deadlines(course.gradebook, course.assignments())
    assert found.due == {TOY: datetime(2026, 11, 30, 15, 59, 59)}
    assert found.extended == {(TOY, '小明 O"Neil'): datetime(2026, 12, 3, 4, 0)}

    assert due(course, TOY, 'none', '--student', '小明 O"Neil') == 0
    assert due(course, TOY, 'none') == 0
    assert f'{TOY}  no due date' in capsys.readouterr().out
    assert deadlines(course.gradebook).due == {}


def test_setting_a_date_keeps_the_rest_of_the_file_as_written(course):
    course.gradebook.mkdir()
    path = course.gradebook / FILE
    path.write_text(
        '# agreed with the dean\n[late]\nper_day = 0.10  # 10 %\n\n[due]\n'
        f'{TOY} = 2026-01-10T23:59:00+01:00\n'
    )
    assert due(course, TOY, '2026-01-11') == 0
    assert path.read_text() == (
        '# agreed with the dean\n[late]\nper_day = 0.10  # 10 %\n\n[due]\n'
        f'{TOY} = 2026-01-11T23:59:59+08:00\n'
    )


def test_a_file_that_notepad_has_written_is_read_and_changed(course):
    course.gradebook.mkdir()
    (course.gradebook / FILE).write_text('\ufeff# ours\n', encoding='utf-8')
    assert due(course, TOY, '2026-11-30') == 0
    assert TOY in deadlines(course.gradebook).due
    assert '# ours' in (course.gradebook / FILE).read_text(encoding='utf-8')


def test_a_date_that_another_process_sets_meanwhile_stays(course, monkeypatch):
    lock = due_dates.gradebook_lock

    @contextlib.contextmanager
    def lock_of_the_second(gradebook):
        monkeypatch.setattr(due_dates, 'gradebook_lock', lock)
        assert due(course, TOY, '2026-12-01', '--student', 'ada') == 0
        with lock(gradebook):
            yield

    assert due(course, TOY, '2026-11-29') == 0
    monkeypatch.setattr(due_dates, 'gradebook_lock', lock_of_the_second)
    assert due(course, TOY, '2026-11-30') == 0
    found = deadlines(course.gradebook)
    assert (found.due[TOY].day, [*found.extended]) == (30, [(TOY, 'ada')])


@pytest.mark.parametrize(
    ('arguments', 'said'),
    [
        (['99_other', '2026-11-30'], f"no assignment '99_other' in solutions/; there are: {TOY}"),
        ([TOY], f'say until when: ./course due {TOY} 2026-11-30'),
        (['--student', 'ada'], './course due ASSIGNMENT DATE --student ada'),
        ([TOY, '2026-11-29', '--student', 'ada'], 'gives nobody more time'),
        ([TOY, 'none'], 'it is extended for ada. Remove these extensions first'),
    ],
)
def test_an_impossible_command_is_reported_and_changes_nothing(course, capsys, arguments, said):
    assert due(course, TOY, '2026-11-30') == 0
    assert due(course, TOY, '2026-12-01', '--student', 'ada') == 0
    before = (course.gradebook / FILE).read_bytes()
    assert due(course, *arguments) == 1
    assert said in capsys.readouterr().err
    assert (course.gradebook / FILE).read_bytes() == before


def test_an_extension_needs_a_due_date(course, capsys):
    assert due(course, TOY, '2026-12-01', '--student', 'ada') == 1
    assert f'./course due {TOY} DATE sets one' in capsys.readouterr().err
    assert not os.path.exists(course.gradebook / FILE)


def test_a_broken_file_of_due_dates_is_not_overwritten(course, capsys):
    course.gradebook.mkdir()
    (course.gradebook / FILE).write_text('[due')
    assert due(course, TOY, '2026-12-01') == 1
    assert 'Due dates, has an example' in capsys.readouterr().err
    assert (course.gradebook / FILE).read_text() == '[due'


def test_an_invalid_date_is_refused(course, capsys):
    with pytest.raises(SystemExit):
        due(course, TOY, 'tomorrow')
    said = capsys.readouterr().err
    assert said.startswith('usage: ./course due ')
    assert said.endswith(": 'tomorrow' is not a date: write 2026-11-30, or none\n")


def test_the_due_dates_of_all_assignments_are_listed_without_arguments(course, capsys):
    assert due(course) == 0
    assert capsys.readouterr().out.splitlines()[0] == f'{TOY}  no due date'


def test_a_changed_date_prints_the_commands_that_apply_the_change(course, capsys):
    assert due(course, TOY, '2026-11-30') == 0
    assert 'Next: ' not in capsys.readouterr().out
    course.folder('submitted', 'ada', TOY).mkdir(parents=True)
    assert due(course, TOY, '2026-12-01') == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last == 'Next: ./course scores, ./course feedback or ./course grade: each counts it'
    assert due(course) == 0
    assert 'Next: ' not in capsys.readouterr().out
