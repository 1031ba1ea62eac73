"""The end of a move that is told late, after a blocking server has answered the next goal."""

import time
from types import SimpleNamespace

import pytest
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from builtin_interfaces.msg import Time
from my_robot_basics.checks.actions.action_ends import ActionEnds
from my_robot_basics.checks.arm.second_goals import _came_after
from my_robot_basics.graph.watcher import Watcher
from rclpy.qos import qos_profile_action_status_default
from unique_identifier_msgs.msg import UUID

from arm_interfaces.action import MoveArm

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


@pytest.mark.parametrize('over_ns', [5 * SECOND_NS, 6 * SECOND_NS + 500_000])
def test_a_goal_that_is_accepted_after_the_move_is_no_second_one(over_ns):
    """Also if only the status of the accepted goal told the end of the one before."""
    assert came_after(over_ns=over_ns, stamp_sec=6)


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


@pytest.mark.starts
def test_an_end_is_not_lost_behind_the_status_of_the_next_goal():
    """Both came while the check read the feedback of a loop that never waits."""
    first, second = (UUID(uuid=[number] * 16) for number in (1, 2))

    def told(*statuses):
        goals = zip((first, second), statuses, strict=False)
        found = [GoalStatus(goal_info=GoalInfo(goal_id=each), status=is_) for each, is_ in goals]
        return GoalStatusArray(status_list=found)

    with Watcher() as watcher:
        ends = ActionEnds(watcher, '/move_arm', MoveArm)
        publisher = watcher.node.create_publisher(
            GoalStatusArray, '/move_arm/_action/status', qos_profile_action_status_default
        )
        assert watcher.spin_until(ends.statuses.is_connected, timeout_sec=10.0)
        publisher.publish(told(GoalStatus.STATUS_EXECUTING))
        assert watcher.spin_until(lambda: bool(ends.statuses_of(first)), timeout_sec=10.0)
        publisher.publish(told(GoalStatus.STATUS_SUCCEEDED))
        time.sleep(0.01)
        next_ns = time.time_ns()
        publisher.publish(told(GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_EXECUTING))
        assert watcher.spin_until(lambda: bool(ends.statuses_of(second)), timeout_sec=10.0)
        assert [name for _, name in ends.statuses_of(first)] == ['executing', 'succeeded']
        assert ends.statuses_of(first)[-1][0] < next_ns
