"""`./course serve` grades what a check could not decide once more, when nothing else is to do."""

import pytest
from course_maker import TOY, with_own_database
from quick_serve import RIGHT, WRONG, arrivals, exchange_in, hand_in, page_of, serve_here

from grader.serving.queue import GRADED


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
    lines = [line for line in said if line.startswith('graded')]
    assert [TOY in line and line.split()[3] for line in lines] == ['ada:', 'bob:', 'ada:']
    assert not any('decide' in line for line in said)
    (graded,) = [each for each in arrivals(course) if each.student_id == 'ada']
    assert (graded.state, graded.score, graded.reason) == (GRADED, 3.0, '')
    page = course.folder('feedback', 'ada', TOY) / f'{TOY}.html'
    assert page_of(inbound, 'aa').read_bytes() == page.read_bytes()
    assert not list((course.gradebook / 'arrived').iterdir())


def test_a_check_that_can_not_decide_is_tried_twice_and_then_left_to_a_person(
    course, inbound, tmp_path
):
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 9')
    said = serve_here(course, inbound)
    assert [line.partition(':')[0] for line in said] == [
        'taken in',
        *['graded'] * 2,
        'not decided',
    ]
    (graded,) = arrivals(course)
    assert graded.reason == 'a check could not decide: ./course grade grades it again'
    assert not list((course.gradebook / 'arrived').iterdir())


def test_a_later_submission_is_graded_in_place_of_an_undecided_one(course, inbound, tmp_path):
    """The undecided one is not graded again: its files are no longer there."""
    hand_in(course, inbound, 'ada', f'{RIGHT}  # {tmp_path} busy 9')
    graded = []

    def say(line):
        if line.startswith('graded'):
            graded.append(line)
            if len(graded) == 1:
                hand_in(course, inbound, 'ada', WRONG, number=2)

    serve_here(course, inbound, say=say)
    assert len(graded) == len(arrivals(course)) == 2
    assert not list((course.gradebook / 'arrived').iterdir())
