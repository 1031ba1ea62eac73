"""Whether feedback shows that it is useless to wait for the end of a move."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks.arm import slow_moves
from my_robot_basics.checks.arm.slow_moves import wait_unless_it_crawls
from my_robot_basics.checks.arm.waits_in_vain import is_in_vain

from arm_interfaces.action import MoveArm

GOAL = (1.0, -0.5)


def sent_with(parts, *, speed=1.0, is_over=False, lengths=2):
    """A goal with ten feedback messages a second, with these parts of the way."""
    told = [
        (number * 10**8, MoveArm.Feedback(position=[part, -part / 2][:lengths]))
        for number, part in enumerate(parts)
    ]
    wanted = MoveArm.Goal(position=GOAL, speed=speed)
    return SimpleNamespace(goal=wanted, feedback=lambda: told, is_over=lambda: is_over)


def evenly(speed, seconds=4):
    """The feedback of an arm that moves that part of its way in each second."""
    return [speed * number / 10 for number in range(10 * seconds)]


@pytest.mark.parametrize(
    ('parts', 'in_vain'),
    [
        (evenly(0.01), True),  # 96 s to go, and at most 15 s
        (evenly(0.05), True),  # 16 s to go
        (evenly(0.06), False),  # 13 s: a busy machine is waited for so long
        ([part**3 for part in evenly(0.2)], False),  # it has begun slowly
        ([0.3] * 40, False),  # nobody knows when one that stands still goes on
        ([-part for part in evenly(0.01)], False),
        (evenly(0.01)[:3], False),
    ],
    ids=['far', 'too far', 'near', 'gets faster', 'stands', 'goes away', 'too little'],
)
def test_a_wait_is_in_vain_if_the_arm_needs_longer_than_the_longest_wait(parts, in_vain):
    assert is_in_vain(sent_with(parts), free_sec=3.0) == in_vain


def test_finished_goals_and_unusable_feedback_show_no_wait_in_vain():
    assert not is_in_vain(sent_with(evenly(0.01), is_over=True), free_sec=3.0)
    assert not is_in_vain(sent_with(evenly(0.01), lengths=1), free_sec=3.0)
    assert not is_in_vain(sent_with(evenly(0.01)), free_sec=3.0, since_ns=37 * 10**8)


class Time:
    """Records the seconds of each wait."""

    def __init__(self, is_driven):
        self.is_driven, self.waits = is_driven, []

    def wait(self, done, *, seconds):
        self.waits.append(round(seconds, 3))
        return done()

    def at_ns(self, wall_ns):
        return wall_ns

    def now_ns(self):
        return 4 * 10**9


@pytest.mark.parametrize(
    ('speed', 'is_driven', 'waits'),
    [
        (0.005, True, [1.0]),
        (0.005, False, [1.0]),
        (0.11, True, [1.0]),
        (0.11, False, [1.0, 2.0]),  # a busy machine may make it so slow
        (0.14, True, [1.0, 2.0]),
    ],
)
def test_the_wait_for_an_arm_ends_early_if_it_crawls(speed, is_driven, waits):
    arm = SimpleNamespace(time=Time(is_driven), start=(0.0, 0.0))
    assert not wait_unless_it_crawls(arm, sent_with(evenly(speed)), GOAL, seconds=3.0)
    assert arm.time.waits == waits


def test_a_crawling_arm_is_detected_after_look_after_sec():
    arm = SimpleNamespace(time=Time(is_driven=True), start=(0.0, 0.0))
    slow = sent_with(evenly(0.01))
    assert not wait_unless_it_crawls(arm, slow, GOAL, seconds=3.0, look_after_sec=0.25)
    assert arm.time.waits == [0.25]
    assert slow_moves.CRAWL_PART < 0.25
