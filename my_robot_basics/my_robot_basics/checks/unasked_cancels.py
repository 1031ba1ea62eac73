"""Requests to cancel a goal without an obstacle, and why a client sends them."""

from my_robot_basics.checks.scripted_action import ReceivedGoal
from my_robot_basics.checks.served_action import ServedAction
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
