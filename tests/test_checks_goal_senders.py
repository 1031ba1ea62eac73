"""Which goals of a client the messages of a check ask for."""

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.actions.goal_senders import AskedGoals
from my_robot_basics.checks.actions.scripted_action import ReceivedGoal


def received(*names):
    return [ReceivedGoal(name, is_accepted=True) for name in names]


def asked(*messages):
    return AskedGoals(
        '/goal_pose',
        '/obstacle',
        messages=[*messages],
        is_for=lambda message, request: message == request,
    )


def test_a_goal_that_no_message_asked_for_fails_with_what_to_do():
    known = asked('a', 'b')
    known.expect_no_others(received('a'))
    known.expect_no_others(received('a', 'b', 'a'))
    with pytest.raises(
        CheckFailed,
        match='no goal but those for the messages on /goal_pose, saw c: send a goal in the callba',
    ):
        known.expect_no_others(received('a', 'b', 'a', 'c'))


def test_goals_from_before_the_first_message_was_handled_may_be_for_earlier_ones():
    known = asked('a')
    known.expect_no_others([])
    known.expect_no_others(received('from the cell before', 'a'))
    known.expect_no_others(received('from the cell before', 'a', 'a'))
    with pytest.raises(CheckFailed, match='saw c'):
        known.expect_no_others(received('from the cell before', 'a', 'c'))
