"""The grade cells' checks of a client of /move_arm."""

import random

from my_robot_basics.checks import action_server, replies
from nodes.running import imported

from arm_interfaces.action import MoveArm

MoveArmClient = imported('move_arm_client').MoveArmClient

WORDS = imported('move_arm_client').WORDS

ENDS = {'asked_on': '/goal_pose', 'to': '/move_arm_client/outcome', 'cancelled_on': '/obstacle'}


def check_outcomes():
    """Do what the grade cell `move_arm_client_outcomes` does."""
    numbers = random.Random(3)
    with action_server('/move_arm', MoveArm, **ENDS) as server:
        replies.expect_ignores_obstacle(server)
        replies.expect_outcomes(
            server, succeeded=(1.2, -0.6), rejected=(1.8, 0.4), aborted=(-0.3, 0.9)
        )
    with action_server('/move_arm', MoveArm, **ENDS, starts=False) as server:
        replies.expect_waiting(server, *replies.choose(numbers, 2))
        replies.expect_outcomes(server, **replies.choose_outcomes(numbers))


def check_cancels():
    """Do what the grade cell `move_arm_client_cancels` does."""
    numbers = random.Random(4)
    with action_server('/move_arm', MoveArm, **ENDS) as server:
        replies.expect_cancel(server, (1.2, -0.6))
        replies.expect_no_cancel(server, (-0.3, 0.9))
        replies.expect_cancel_in_spite_of_a_second_goal(server, (0.4, 0.4), (0.8, -0.2))
    with action_server('/move_arm', MoveArm, **ENDS) as server:
        replies.expect_cancel(server, *replies.choose(numbers, 1))
        replies.expect_refused_cancel(server, *replies.choose(numbers, 1))
