"""`./course serve` grades what a check could not decide once more, when nothing else is to do."""

import shutil

import pytest
from course_maker import TOY, with_own_database
from quick_serve import (
    RIGHT,
    WRONG,
    arrivals,
    exchange_in,
    grade_here,
    hand_in,
    page_of,
    serve_here,
)

from grader.grading import GONE
from grader.serving import serve as serve_module
from grader.serving.queue import FAILED, GRADED
from grader.serving.queue_file import open_queue_to_read
from grader.serving.status import status_lines
from grader.storage.pipeline import is_undecided
from grader.storage.records import graded_notebook


@pytest.fixture
def course(released, tmp_path):
    return with_own_database(released, tmp_path)


@pytest.fixture
def inbound(tmp_path):
    return exchange_in(tmp_path)


def test_a_check_that_could_not_decide_is_tried_again_when_nothing_else_is_to_do(
    course, inbound, tmp_path
):
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 1', secret='aa')
    hand_in(course, inbound, 'bob', RIGHT)
    said = serve_here(course, inbound)
    assert [line.split()[::3][:2] for line in said if 'graded' in line] == [
        ['undecided:', 'ada:'],
        ['graded:', 'bob:'],
        ['graded:', 'ada:'],
    ]
    (graded,) = [each for each in arrivals(course) if each.student_id == 'ada']
    assert (graded.state, graded.score, graded.reason) == (GRADED, 3.0, '')
    page = course.folder('feedback', 'ada', TOY) / f'{TOY}.html'
    assert page_of(inbound, 'aa').read_bytes() == page.read_bytes()
    assert not list((course.gradebook / 'arrived').iterdir())


def test_a_check_that_can_not_decide_is_tried_twice_and_then_left_to_a_person(
    course, inbound, tmp_path, capsys
):
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 2')
    said = serve_here(course, inbound)
    assert [line.partition(':')[0] for line in said] == ['taken in', 'undecided', 'undecided']
    assert [said.rpartition('; ')[2] for said in said[1:]] == [
        'it is graded once more when there is time',
        './course grade tries again',
    ]
    (graded,) = arrivals(course)
    assert (graded.state, graded.reason) == (FAILED, 'a check could not decide')
    assert not list((course.gradebook / 'arrived').iterdir())
    heading = 'Not graded, or not to the end: ./course grade tries again'
    assert heading in status(course)
    grade_here(course)
    assert heading not in status(course)  # now it is decided


def test_an_undecided_submission_is_graded_again_by_the_next_process(course, inbound, tmp_path):
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 1', secret='aa')

    def is_killed(line):
        if line.startswith('undecided'):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        serve_here(course, inbound, say=is_killed)
    # the result was stored, but killed before that was recorded: it waits again
    said = serve_here(course, inbound)
    assert said[-1].startswith('graded')


def test_an_undecided_submission_is_found_by_the_next_process(
    course, inbound, tmp_path, monkeypatch
):
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 1', secret='aa')

    def is_killed(serving):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(serve_module, 'grade_undecided', is_killed)
        with pytest.raises(KeyboardInterrupt):
            serve_here(course, inbound)
    assert 'graded once more when there is time' in status(course)
    (line,) = serve_here(course, inbound)
    assert line.startswith(f'graded: {TOY} of ada: 3 of 5')
    page = course.folder('feedback', 'ada', TOY) / f'{TOY}.html'
    assert page_of(inbound, 'aa').read_bytes() == page.read_bytes()


def test_a_later_submission_is_graded_in_place_of_an_undecided_one(course, inbound, tmp_path):
    """The undecided one is not graded again: its files are no longer there."""
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 9')
    said = []

    def say(line):
        said.append(line.partition(':')[0])
        if said == ['taken in', 'undecided']:
            hand_in(course, inbound, 'ada', WRONG, number=2)

    serve_here(course, inbound, say=say)
    assert said == ['taken in', 'undecided', 'taken in', 'graded']
    assert [each.reason for each in arrivals(course)] == [
        'a check could not decide, and a later one was graded',
        '',
    ]
    assert not list((course.gradebook / 'arrived').iterdir())


def test_the_first_result_stays_if_the_folder_is_removed_before_the_second_grading(
    course, inbound, tmp_path
):
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 1')
    said = []

    def say(line):
        said.append(line)
        if line.startswith('undecided'):
            shutil.rmtree(course.folder('submitted', 'ada', TOY))

    serve_here(course, inbound, say=say)
    assert said[-1] == f'not graded again: {TOY} of ada: {GONE}'
    (failed,) = arrivals(course)
    assert (failed.state, failed.reason) == (FAILED, GONE)
    assert is_undecided(graded_notebook(course, 'ada', TOY))


def status(course):
    with open_queue_to_read(course.gradebook) as queue:
        return '\n'.join(status_lines(course, queue))
