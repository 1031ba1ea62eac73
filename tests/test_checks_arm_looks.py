"""Whether a slow arm follows the robot's clock: the arm stands still while the clock does."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import arm_looks
from my_robot_basics.checks.robot_time import DrivenTime


class Clock(DrivenTime):
    """A clock that brings some feedback while it stands still."""

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
def test_a_slow_arm_that_pauses_with_the_clock_follows_it(monkeypatch, is_slow, comes, follows):
    told = ['…'] * 5
    monkeypatch.setattr(arm_looks, 'is_under_way', lambda *_: is_slow)
    arm = SimpleNamespace(time=Clock(told, comes))
    sent = SimpleNamespace(feedback_count=lambda: len(told))
    assert arm_looks._moves_with_clock(arm, sent, (1.0, -0.5)) == follows


@pytest.mark.parametrize(
    ('gone', 'moves_on'),
    [
        ([0.1, 0.2, 0.3, 0.4, 0.5], True),
        ([0.1, 0.2, 0.3, 0.4], False),
        ([0.0, 0.0, 0.4, 0.4, 0.4, 0.4], False),
        ([0.0] * 9, False),
        ([], False),
    ],
    ids=['at each step', 'too few', 'a late clock', 'stands still', 'says nothing'],
)
def test_an_arm_that_moves_while_its_clock_stands_still_uses_the_wall_clock(gone, moves_on):
    told = []

    def let_it_report(done, *, free_sec):
        assert not done()
        assert free_sec > 0.0
        told.extend((0, SimpleNamespace(position=[each, 0.0])) for each in gone)

    arm = SimpleNamespace(
        server=SimpleNamespace(watcher=SimpleNamespace(spin_until_free=let_it_report))
    )
    sent = SimpleNamespace(
        is_over=lambda: False, feedback=lambda: told, feedback_count=lambda: len(told)
    )
    assert arm_looks._moves_on(arm, sent) == moves_on
