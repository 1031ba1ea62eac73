"""Which of several submissions counts: only the times of platforms and files decide."""

import pytest
from incoming_files import ADA, ASSIGNMENTS, BLACKBOARD, arriving, owners, time_of

from grader.collect.matching import match


@pytest.fixture
def at(tmp_path):
    return arriving(tmp_path)


def test_the_time_of_a_submission_is_from_the_exchange_or_the_file(at):
    notebook = at('ada/02_joint_state/02_joint_state.ipynb')
    stamp = at('ada/02_joint_state/timestamp.txt', '2026-03-04 05:06:07.89 UTC\n')
    assert time_of(notebook, stamp) == ('03-04 05:06:07', [])
    assert time_of(notebook) == (None, [])
    assert time_of(notebook, file_times=True) == ('01-01 12:00:00', [])
    assert time_of(notebook, stamp, file_times=True) == ('03-04 05:06:07', [])
    zone = at('ada/02_joint_state/timestamp.txt', '2026-03-04 05:06:07 +0200')
    assert time_of(notebook, zone) == ('03-04 03:06:07', [])
    exchange = 'ada+02_joint_state+2026-02-03 04:05:06.7 UTC'
    exchanged = at(f'{exchange}/02_joint_state.ipynb'), at(f'{exchange}/timestamp.txt', 'soon')
    assert time_of(*exchanged) == ('02-03 04:05:06', ['it holds no date'])


LATE = 'has marked it as late, but no time is known, so it counts as in time: if the files'


@pytest.mark.parametrize(
    ('path', 'platform'),
    [
        ('ada_LATE_18151_21012_02_joint_state.ipynb', 'Canvas'),
        ('Lovelace_Ada_ada_4711/Late Submission - 02_joint_state.ipynb', 'ILIAS'),
        ('Lovelace_Ada_ada_4711/Late Submission - homework.zip/02_joint_state.ipynb', 'ILIAS'),
    ],
)
def test_a_platform_s_mark_of_lateness_without_a_time_is_reported(path, platform, at):
    (taken,), left = match([at(path)], ASSIGNMENTS)
    assert (taken.remark.startswith(f'{platform} {LATE}'), left) == (True, [])
    (taken,), _ = match([at(path)], ASSIGNMENTS, file_times=True)
    assert taken.remark == ''


@pytest.mark.parametrize(
    'path',
    [
        'ada_18151_21012_LATE_02_joint_state.ipynb',
        'Lovelace_Ada_ada_4711/homework.zip/Late Submission - 02_joint_state.ipynb',
        f'{ADA}/Late Submission - 02_joint_state.ipynb',
    ],
)
def test_a_mark_of_lateness_that_a_student_wrote_says_nothing(path, at):
    for taken in match([at(path)], ASSIGNMENTS)[0]:
        assert taken.remark == ''


def test_a_timestamp_in_an_archive_of_a_student_is_not_used(at):
    notebook, stamp = at('ada.zip/02_joint_state.ipynb'), at('ada.zip/timestamp.txt', '2020-01-01')
    assert time_of(notebook, stamp) == (
        None,
        ['its time is not used: a student can write any time into an archive'],
    )


def test_several_notebooks_of_one_exercise_are_put_in_order_by_their_times(at):
    exchange = 'ada+02_joint_state+2026-01-0{} 10:00:00 UTC/02_joint_state.ipynb'
    hand_ins, left = match([at(exchange.format(day)) for day in (3, 1, 2)], ASSIGNMENTS)
    assert [each.handed_in.day for each in hand_ins] == [1, 2, 3]
    assert left == []


def test_different_notebooks_without_distinct_times_are_left_out(at):
    two = at('ada_02_joint_state.ipynb', 'one'), at('ada-02_joint_state.ipynb', 'two')
    for options in ({}, {'file_times': True}):  # the times of the files are equal, too
        taken, left = owners(*two, **options)
        assert taken == []
        assert [path for path, _ in left] == [each.path for each in two]
        assert all('one of 2 notebooks for 02_joint_state by ada' in why for _, why in left)


def test_two_equal_notebooks_count_as_one_submission(at):
    two = at('ada_02_joint_state.ipynb', 'one'), at('ada-02_joint_state.ipynb', 'one')
    taken, [(_, why)] = owners(*two)
    assert taken == [('ada', '02_joint_state')]
    assert why == 'the same again'


def test_blackboard_says_which_attempt_is_the_latest(at):
    attempts = [at(BLACKBOARD.format('ada', day), day) for day in ('10', '09', '11')]
    hand_ins, left = match(attempts, ASSIGNMENTS)
    assert [each.notebook for each in hand_ins] == [attempts[1], attempts[0], attempts[2]]
    assert left == []
    # the platform's clock is taken to be this machine's
    local = hand_ins[0].handed_in.astimezone()
    assert local.strftime('%m-%d %H:%M:%S') == '01-09 03:04:05'


def test_an_invalid_time_in_a_file_name_is_ignored(at):
    assert time_of(at(BLACKBOARD.format('ada', '41'))) == (None, [])


@pytest.mark.parametrize(
    'upload', [ADA, 'lovelaceada_18151_21012_homework.zip', f'{ADA}/homework.zip']
)
@pytest.mark.parametrize('inside', ['', '/ada lovelace'])
def test_a_timestamp_in_an_upload_of_a_student_is_not_used(upload, inside, at):
    notebook = at(f'{upload}{inside}/03_publisher.ipynb')
    stamp = at(f'{upload}{inside}/timestamp.txt', '2020-01-01 00:00:00 UTC')
    when, [why] = time_of(notebook, stamp)
    assert when is None
    assert 'its time is not used' in why
    assert time_of(notebook, stamp, file_times=True)[0] == '01-01 12:00:00'


@pytest.mark.parametrize('upload', [ADA, 'ada lovelace.zip', f'{ADA}/homework.zip'])
def test_a_time_in_the_name_of_an_uploaded_folder_is_not_used(upload, at):
    folder = f'{upload}/Ada Lovelace+03_publisher+2020-01-01 00:00:00 UTC'
    for options, when in (({}, None), ({'file_times': True}, '01-01 12:00:00')):
        assert time_of(at(f'{folder}/03_publisher.ipynb'), **options) == (when, [])
