"""How exact a speed has to be, whatever the machine: 2 % of a robot minute."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed, arm_speed, moves

MINUTE = (1.2, -0.6)
SPEED = 0.02


def judge(seconds):
    """What comes of a move of one robot minute that took so long, also in finer steps."""
    arm = SimpleNamespace(
        start=(0.0, 0.0),
        time=SimpleNamespace(is_driven=True),
        seconds=lambda sent: seconds,
        doubt=lambda: CheckFailed,
    )
    sent = SimpleNamespace(goal=moves.goal(MINUTE, speed=SPEED))
    arm_speed.expect_speed(arm, sent, MINUTE)


@pytest.fixture(autouse=True)
def _slow_in_finer_steps_too(monkeypatch):
    monkeypatch.setattr(arm_speed, '_is_right_in_finer_steps', lambda *_: False)


@pytest.mark.parametrize('seconds', [58.9, 60.0, 61.2])
def test_two_percent_are_right(seconds):
    judge(seconds)


@pytest.mark.parametrize(
    ('seconds', 'hint'),
    [
        (58.0, 'in each step, move by speed'),
        (62.0, 'in each step, move by speed × the time that passed'),
        (60.0 / 57.29578, 'the speed is in rad/s already'),
        (60.0 * 57.29578, 'the speed is in rad/s already'),
        (60.0 * 1.25**0.5, 'the speed is that of the faster joint'),
        (90.0, 'both joints move at once'),
        (30.0, 'the speed is that of the joint that has farther to go'),
        (0.05, 'the arm jumps'),
    ],
)
def test_another_speed_is_named(seconds, hint):
    with pytest.raises(CheckFailed, match=hint):
        judge(seconds)
