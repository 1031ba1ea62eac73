"""How a check distinguishes a slow arm from one that never arrives."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.arm import arm_refusals
from my_robot_basics.checks.arm.arm_progress import LATEST_SEC, is_under_way

from arm_interfaces.action import MoveArm

GOAL = (1.0, -0.5)


def is_slow(parts, *, since_sec=0.0, is_over=False, lengths=2):
    """Whether ten messages a second with these parts of the way mean a slow arm."""
    told = [
        (number * 10**8, MoveArm.Feedback(position=[part, -part / 2][:lengths]))
        for number, part in enumerate(parts)
    ]
    now_ns = len(parts) * 10**8 + round(since_sec * 1e9)
    arm = SimpleNamespace(
        time=SimpleNamespace(now_ns=lambda: now_ns, at_ns=lambda wall_ns: wall_ns)
    )
    sent = SimpleNamespace(feedback=lambda: told, is_over=lambda: is_over)
    return is_under_way(arm, sent, GOAL)


def evenly(speed):
    """Four seconds of feedback, with that part of the way in each tenth of a second."""
    return [speed * number for number in range(40)]


def test_a_slow_arm_is_under_way():
    assert is_slow(evenly(0.01))
    assert not is_slow(evenly(0.01), is_over=True)


def test_an_arm_at_its_goal_is_not_under_way():
    assert not is_slow([*evenly(0.03), *[1.0] * 10])


def test_an_arm_that_approaches_ever_more_slowly_is_not_under_way():
    assert not is_slow([1.0 - 0.9**number for number in range(40)])


def test_an_arm_that_stands_still_or_moves_away_is_not_under_way():
    assert not is_slow([0.3] * 40)
    assert not is_slow([-part for part in evenly(0.01)])
    assert not is_slow([min(0.2, part) for part in evenly(0.02)])


def test_an_arm_that_stopped_sending_feedback_is_not_under_way():
    assert not is_slow(evenly(0.01), since_sec=2 * LATEST_SEC)


def test_feedback_that_is_too_short_or_of_one_joint_shows_no_slow_arm():
    assert not is_slow(evenly(0.01)[:3])
    assert not is_slow(evenly(0.01), lengths=1)


def test_a_server_that_rejects_only_fast_goals_reads_that_each_speed_is_allowed(monkeypatch):
    arm = SimpleNamespace(send=lambda first, other: SimpleNamespace(goal=other))
    monkeypatch.setattr(arm_refusals, 'look', lambda action, body, start: body(arm))
    wanted = 'it rejected, and one at 0.5 rad/s accepted: every speed above 0 is allowed'
    with pytest.raises(CheckFailed, match=wanted):
        arm_refusals.expect_accepts(None, GOAL)
