"""What a client of `/move_arm` must do with the server's responses; positions in radians."""

import random
from collections.abc import Sequence
from functools import partial
from typing import NoReturn

from sensor_msgs.msg import JointState

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.actions.scripted_action import Ending, ReceivedGoal
from my_robot_basics.checks.actions.served_action import ServedAction
from my_robot_basics.checks.arm.absent_servers import publish_in_vain
from my_robot_basics.checks.arm.half_way import half_way
from my_robot_basics.checks.arm.outcome_words import why_another_word
from my_robot_basics.checks.arm.unasked_cancels import (
    expect_no_goal_for_false,
    expect_none_for_another,
    expect_none_for_earlier,
    expect_none_for_false,
)
from my_robot_basics.checks.arm.watched_arm import Pose
from my_robot_basics.checks.values import joints

SPEED = 0.5
"""The speed that the client must request, in rad/s."""
EXACT = 1e-6
SUBSCRIBES_SEC = 2.0
"""How long to wait until the client's subscription to obstacles is known, in s of free time."""
OUTCOMES: tuple[Ending, ...] = ('succeeded', 'aborted')


def choose(numbers: random.Random, count: int) -> list[tuple[float, float]]:
    """Choose `count` positions that differ clearly from each other."""
    chosen: list[tuple[float, float]] = []
    while len(chosen) < count:
        pose = round(numbers.uniform(-1.4, 1.4), 5), round(numbers.uniform(-2.0, 2.0), 5)
        if all(abs(pose[0] - other[0]) > 0.05 for other in chosen):
            chosen.append(pose)
    return chosen


def choose_outcomes(numbers: random.Random) -> dict[str, tuple[float, float]]:
    """A position for each outcome that `expect_outcomes` knows, in random order."""
    words = ['succeeded', 'rejected', 'aborted']
    numbers.shuffle(words)
    return dict(zip(words, choose(numbers, len(words)), strict=True))


def expect_ignores_obstacle(server: ServedAction) -> None:
    """An obstacle while there is no goal changes nothing, for example raises no exception.

    A client that does not subscribe to obstacles passes: another check asks for that. Raises
    CheckFailed.
    """
    node, topic_name = server.watcher.node, server.cancelled_on
    subscribes = partial(node.count_subscribers, topic_name)
    if server.watcher.spin_until_free(lambda: subscribes() > 0, free_sec=SUBSCRIBES_SEC):
        server.say_obstacle(is_there=True)
        server.say_obstacle(is_there=False)
        server.expect_no_outcome('there is no goal')


def expect_outcomes(server: ServedAction, **positions: Pose) -> None:
    """Each position leads to a goal that ends as its word says; the client publishes that word.

    `expect_outcomes(server, succeeded=(0.5, 0.2), rejected=(1.0, 0.4))`. Raises CheckFailed.
    """
    server.may_sleep = False  # in this check alone, so that one error costs the points of one
    for word, position in positions.items():
        if word == 'rejected':
            _expect_rejected(server, position)
        elif word in OUTCOMES:
            goal = ask(server, position)
            server.expect_no_outcome('the goal has not ended')
            goal.finish('succeeded' if word == 'succeeded' else 'aborted')
            _expect(server, word)
        else:
            _refuse(word)


def expect_waiting(server: ServedAction, early: Pose, later: Pose) -> None:
    """A client that gets the `early` pose without a server still sends a goal for the `later` one.

    The server starts between the two, and succeeds after a while. The client must neither block
    while there is no server, nor publish an outcome too soon. Raises CheckFailed.
    """
    publish_in_vain(server, _pose(early))
    server.let_client_know()  # otherwise the client may process it when there is a server
    server.start()
    goal = ask(server, later)
    server.forget_outcomes()  # a goal for the early pose may have come late, and succeeded
    server.expect_no_outcome('the server takes its time')
    goal.finish('succeeded')
    _expect(server, 'succeeded')


def expect_cancel(server: ServedAction, position: Pose) -> None:
    """An obstacle cancels the goal for good; the client publishes so. Raises CheckFailed."""
    _expect_cancel_of(server, ask(server, position))
    expect_no_goal_for_false(server)


def expect_no_cancel(server: ServedAction, position: Pose) -> None:
    """The client does not cancel a goal for an obstacle before the goal, or for False.

    Raises CheckFailed.
    """
    server.say_obstacle(is_there=True)
    server.let_client_know()  # without this, the pose may overtake it: two topics have no order
    goal = ask(server, position)
    expect_none_for_earlier(server, goal)
    server.say_obstacle(is_there=False)
    expect_none_for_false(server, goal)
    goal.finish('succeeded')
    _expect(server, 'succeeded')


def expect_refused_cancel(server: ServedAction, position: Pose) -> None:
    """The server rejects the request to cancel; the goal succeeds, and the client publishes so.

    Raises CheckFailed.
    """
    server.cancels = False
    goal = ask(server, position)
    server.expect_cancel_of(goal)
    server.expect_no_outcome('the goal has not ended')
    goal.finish('succeeded')
    _expect(server, 'succeeded')
    server.cancels = True


def expect_cancel_in_spite_of_a_second_goal(
    server: ServedAction, first: Pose, second: Pose
) -> None:
    """While the first goal executes, a second one is rejected; an obstacle cancels the first.

    Raises CheckFailed.
    """
    goal = ask(server, first)
    _expect_rejected(server, second)
    expect_none_for_another(server, goal)
    _expect_cancel_of(server, goal)


def ask(server: ServedAction, position: Pose, *, accepts: bool = True) -> ReceivedGoal:
    """Publish a position; return the goal that the client sends for it. Raises CheckFailed."""
    server.accepts, server.reports = accepts, half_way
    server.asked.is_for = lambda pose, request: _is_near(request.position, pose.position)

    def is_it(request: MoveArm.Goal) -> bool:
        return _is_near(request.position, position) and abs(request.speed - SPEED) < EXACT

    def why(request: MoveArm.Goal) -> str:
        if _is_near(request.position, position):
            return 'give each goal the speed that the task names'
        return _why_other(request.position, position)

    return server.ask(_pose(position), is_it=is_it, hint=why)


def _expect_rejected(server: ServedAction, position: Pose) -> None:
    ask(server, position, accepts=False)
    _expect(server, 'rejected')
    server.accepts = True


def _expect_cancel_of(server: ServedAction, goal: ReceivedGoal) -> None:
    server.expect_cancel_of(goal)
    server.expect_no_outcome('the server has not said how the goal ended')
    goal.finish('canceled')
    _expect(server, 'canceled')


def _expect(server: ServedAction, word: str) -> None:
    server.expect_outcome(word, hint=partial(why_another_word, word, last=server.client.told()))


def _pose(position: Pose) -> JointState:
    return JointState(name=['joint1', 'joint2'], position=list(position))


def _is_near(seen: Sequence[float], wanted: Pose) -> bool:
    return len(seen) == len(wanted) and all(
        abs(a - b) < EXACT for a, b in zip(seen, wanted, strict=True)
    )


def _why_other(seen: Sequence[float], wanted: Pose) -> str:
    if not seen:
        return 'fill in goal.position: MoveArm.Goal(position=…, speed=…)'
    own, swapped = ({str(i): each for i, each in enumerate(p)} for p in (seen, wanted[::-1]))
    if joints.agree(own, swapped):
        return 'the joints are swapped'
    return 'put the positions of the pose into goal.position, as they are: in radians'


def _refuse(word: str) -> NoReturn:
    raise ValueError(f'expect_outcomes knows succeeded, rejected and aborted, not {word}')
