"""Whether a slow arm follows the robot's clock: it stands still while that does."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import arm_looks
from my_robot_basics.checks.robot_time import DrivenTime


class Clock(DrivenTime):
    """While it stands still, some feedback comes."""

    def __init__(self, told, comes):
        self.told, self.comes = told, comes

    def hold(self, seconds):
        assert seconds > 0.0
        self.told += ['…'] * self.comes


@pytest.mark.parametrize(
    ('is_slow', 'comes', 'follows'),
    [(True, 0, True), (True, 1, True), (True, 2, False), (False, 0, False)],
    ids=['stands still', 'was under way', 'goes on', 'is not slow'],
)
def test_a_slow_arm_follows_the_clock_with_which_it_stands_still(
    monkeypatch, is_slow, comes, follows
):
    told = ['…'] * 5
    monkeypatch.setattr(arm_looks, 'is_under_way', lambda *_: is_slow)
    arm = SimpleNamespace(time=Clock(told, comes))
    sent = SimpleNamespace(feedback_count=lambda: len(told))
    assert arm_looks._moves_with_clock(arm, sent, (1.0, -0.5)) == follows
