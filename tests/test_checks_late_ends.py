"""The end of a move that is told late, after a blocking server has answered the next goal."""

from types import SimpleNamespace

import pytest
from builtin_interfaces.msg import Time
from my_robot_basics.checks.arm.second_goals import _came_after

SECOND_NS = 10**9


def came_after(*, over_ns, stamp_sec, is_driven=False):
    """Whether a goal with that stamp came after a move that ended at `over_ns`, and says so."""
    moving = SimpleNamespace(is_over=lambda: over_ns > 0, over_ns=lambda: over_ns)
    watcher = SimpleNamespace(spin_until_free=lambda done, free_sec: done())
    time = SimpleNamespace(is_driven=is_driven)
    arm = SimpleNamespace(time=time, server=SimpleNamespace(watcher=watcher))
    response = SimpleNamespace(stamp=Time(sec=stamp_sec))
    answer = SimpleNamespace(result=lambda: response)
    return _came_after(moving, arm, SimpleNamespace(answer=answer))


def test_a_goal_that_is_accepted_after_the_move_is_no_second_one():
    assert came_after(over_ns=5 * SECOND_NS, stamp_sec=6)


@pytest.mark.parametrize(
    'seen',
    [
        {'over_ns': 7 * SECOND_NS, 'stamp_sec': 6},
        {'over_ns': 0, 'stamp_sec': 6},
        {'over_ns': 5 * SECOND_NS, 'stamp_sec': 6, 'is_driven': True},
    ],
    ids=['replaced', 'moves on', 'answers during moves'],
)
def test_a_goal_that_is_accepted_during_the_move_is(seen):
    assert not came_after(**seen)
