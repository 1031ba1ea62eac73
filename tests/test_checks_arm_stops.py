"""What a check reads from the result of a cancelled goal, with made-up positions."""

import math
from types import SimpleNamespace

import pytest
from my_robot_basics.checks.arm.arm_stops import expect_on_the_way, last_told
from my_robot_basics.checks.arm.cancel_moments import moment_to_cancel
from my_robot_basics.feedback.errors import CheckFailed

from arm_interfaces.action import MoveArm

GOAL = (1.2, -0.6)


def hint(*position, told=()):
    """Return why a goal from (0, 0) to GOAL can't have been stopped there; '' if it can."""
    sent = SimpleNamespace(
        result=MoveArm.Result(position=position),
        feedback=lambda: [(0, MoveArm.Feedback(position=each)) for each in told],
        sent_ns=0,
    )
    arm = SimpleNamespace(server=SimpleNamespace(log=SimpleNamespace(raised=lambda since_ns: '')))
    try:
        expect_on_the_way(arm, sent, GOAL, start=(0.0, 0.0))
    except CheckFailed as failure:
        return str(failure)
    return ''


@pytest.mark.parametrize(
    ('position', 'why'),
    [
        ((0.49, -0.245), ''),
        ((0.49, 0.245), 'the sign of joint2 is wrong'),
        ((-0.49, -0.245), 'the sign of joint1 is wrong'),
        ((-0.49, 0.245), 'both signs are wrong'),
        ((28.07, -14.04), 'these are degrees'),
        ((-0.245, 0.49), 'the joints are swapped'),
        ((0.49, -2.0), 'put in where the arm was stopped'),
        ((1.2, -0.6), 'put in where the arm is, not where it was to go'),
        ((), 'fill in the result of a goal that was cancelled'),
    ],
)
def test_a_result_that_is_not_on_the_way_is_named_by_its_mistake(position, why):
    found = hint(*position)
    assert why in found
    assert bool(found) == bool(why)


@pytest.mark.parametrize(
    ('position', 'told', 'is_right'),
    [
        ((0.0, -0.3), [(0.0, -0.1), (0.0, -0.29)], True),
        ((0.0, -0.3), [(0.0, -0.1), (0.0, -0.2)], False),
        ((0.0, -0.3), [], False),
        # it has not moved, or far beyond its way
        ((0.0, 0.0), [(0.0, 0.0)], False),
        ((0.0, -2.0), [(0.0, -2.0)], False),
        ((28.07, -14.04), [(28.07, -14.04)], False),
    ],
)
def test_an_arm_may_be_stopped_before_its_far_joint_moves_if_its_feedback_says_so(
    position, told, is_right
):
    """One that moves joint2 first, and then joint1, loses the points of the feedback."""
    assert (hint(*position, told=told) == '') == is_right


@pytest.mark.parametrize('looks_sec', [0.5, 1.0])
@pytest.mark.parametrize('is_driven', [True, False])
@pytest.mark.parametrize('move_sec', [2.4, 3.1, 4.7, 6.0, 14.0])
def test_a_server_that_looks_twice_a_second_is_late_whenever_its_goal_is_cancelled(
    looks_sec, is_driven, move_sec
):
    """With 2.4 s of 6.0, it stopped in time by chance, and the visible check passed."""
    asked_sec = moment_to_cancel(move_sec, is_driven=is_driven)
    assert 0.2 * move_sec < asked_sec < 0.7 * move_sec
    assert -asked_sec % looks_sec > 0.3


@pytest.mark.parametrize('looks_sec', [0.4, 0.5, 0.6, 0.7, 0.8, 1.0])
@pytest.mark.parametrize('move_sec', [6.0, 8.0, 10.0, 14.0])
def test_a_server_that_looks_at_other_intervals_is_late_in_the_visible_check(looks_sec, move_sec):
    """With 0.4 s, it earned all points in 5 of 12 gradings, depending on hidden angles."""
    assert -moment_to_cancel(move_sec, is_driven=True) % looks_sec > 0.3


def test_a_move_of_two_seconds_is_surely_over_when_the_open_check_cancels_a_longer_one():
    """At 2.05 s, a server whose moves take two seconds each was sometimes told something else."""
    assert moment_to_cancel(8.0, is_driven=True) == pytest.approx(3.65)
    assert moment_to_cancel(6.0, is_driven=True) == pytest.approx(3.65)
    assert moment_to_cancel(6.0, is_driven=False) == 2.55


@pytest.mark.parametrize('is_driven', [True, False])
def test_a_brief_move_is_cancelled_on_its_way(is_driven):
    assert moment_to_cancel(0.75, is_driven=is_driven) == pytest.approx(0.3, abs=0.06)


@pytest.mark.parametrize(
    ('told', 'where'),
    [
        ([[0.1, 0.2], [0.8, -0.4]], (0.8, -0.4)),
        ([], (0.0, 0.0)),
        ([[0.8]], (0.0, 0.0)),
        ([[math.nan, 0.1]], (0.0, 0.0)),
    ],
)
def test_without_a_result_the_last_feedback_says_where_the_arm_was_stopped(told, where):
    """From there, the next move takes longer: nobody waited for it, and all points were earned."""
    messages = [(0, SimpleNamespace(position=position)) for position in told]
    assert last_told(SimpleNamespace(feedback=lambda: messages), (0.0, 0.0)) == where
