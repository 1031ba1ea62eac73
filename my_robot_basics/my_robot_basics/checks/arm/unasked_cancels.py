"""Requests to cancel without an obstacle, goals for the end of one, and why clients send them."""

from my_robot_basics.checks.actions.scripted_action import ReceivedGoal
from my_robot_basics.checks.actions.served_action import QUIET_SEC, ServedAction
from my_robot_basics.feedback.errors import expect

CAUSE = 'a goal is cancelled without an obstacle'


def expect_none_for_earlier(server: ServedAction, goal: ReceivedGoal) -> None:
    """The client does not cancel a goal for an obstacle before the goal. Raises CheckFailed."""
    expect(
        not server.is_cancelled(goal, soon=False),
        expected=f'no request to cancel a goal that came after True on {server.cancelled_on}',
        seen='one',
        hint='an obstacle cancels the goal that moves the arm then, and no later one',
        cause=CAUSE,
    )


def expect_none_for_another(server: ServedAction, goal: ReceivedGoal) -> None:
    """The client does not cancel the goal because it sent another one. Raises CheckFailed."""
    expect(
        not server.is_cancelled(goal, soon=True),
        expected=f'no request to cancel the goal that moves the arm for a message on '
        f'{server.asked_on}',
        seen='one',
        hint='send the new goal and cancel nothing: only an obstacle cancels the goal that moves '
        'the arm',
        cause=CAUSE,
    )


def expect_none_for_false(server: ServedAction, goal: ReceivedGoal) -> None:
    """The client does not cancel the goal for False on `cancelled_on`. Raises CheckFailed."""
    expect(
        not server.is_cancelled(goal, soon=False),
        expected=f'no request to cancel the goal for False on {server.cancelled_on}',
        seen='one',
        hint='look at message.data: only True asks to cancel',
        cause=CAUSE,
    )


def expect_no_goal_for_false(server: ServedAction) -> None:
    """The client sends no goal for False on `cancelled_on`. Raises CheckFailed."""
    before = len(server.goals)
    server.say_obstacle(is_there=False)
    expect(
        not server.watcher.spin_until(lambda: len(server.goals) > before, timeout_sec=QUIET_SEC),
        expected=f'no goal for False on {server.cancelled_on}',
        seen='one',
        hint=f'False changes nothing: only a message on {server.asked_on} becomes a goal, so do '
        'not resume the goal that was cancelled',
        cause='a goal is sent when an obstacle is gone',
    )
