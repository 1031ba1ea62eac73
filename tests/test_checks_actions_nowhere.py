"""For an action server whose arm gets nowhere, each check says why."""

import asyncio

import pytest
from arm_checks import CHECKS, reaches
from my_robot_basics.checks import CheckFailed, action
from my_robot_basics.live import wait_until
from nodes.running import imported
from rclpy.action import ActionClient
from rclpy.node import Node

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer
STEP_SEC = imported('move_arm_server').STEP_SEC


class ReturnsTrue(MoveArmServer):
    def judge(self, goal):
        return self.is_possible(goal)


class FlagStuck(MoveArmServer):
    def finish(self, handle):
        result = super().finish(handle)
        self.is_moving = True
        return result


class ReturnsNothing(MoveArmServer):
    def finish(self, handle):
        super().finish(handle)


class RaisesInExecute(MoveArmServer):
    def step(self, handle):
        raise KeyError('joint3')


class ReportsNumbers(MoveArmServer):
    def report(self, handle):
        handle.publish_feedback(self.position)


class ReportsAResult(MoveArmServer):
    def report(self, handle):
        handle.publish_feedback(MoveArm.Result(position=self.position))


class SucceedsWithTheResult(MoveArmServer):
    def finish(self, handle):
        self.is_moving = False
        handle.succeed(MoveArm.Result(position=self.position))


class SleepsWithAsyncio(MoveArmServer):
    async def execute(self, handle):
        await asyncio.sleep(0.05)


class NeverExecutes(MoveArmServer):
    def make_server(self, **callbacks):
        return super().make_server(handle_accepted_callback=lambda handle: None, **callbacks)


class NeverEnds(MoveArmServer):
    def step(self, handle):
        super().step(handle)
        self.part = 0.5


class WaitsForItsOwnTimer(MoveArmServer):
    def execute(self, handle):
        self.create_rate(20).sleep()


NO_FEEDBACK = (
    r'the execute callback raised an exception without a text, such as a TypeError: give '
    r'publish_feedback a MoveArm\.Feedback\(position=…, remaining=…\); fix that first'
)
NOWHERE = [
    (
        ReturnsTrue,
        'end the goal callback with `return GoalResponse.ACCEPT` or `GoalResponse.RE',
    ),
    (FlagStuck, 'see that the node knows that the arm moves no longer'),
    (ReturnsNothing, r'end the execute callback with `return MoveArm.Result\(position=…\)`'),
    (
        RaisesInExecute,
        'the execute callback raised an exception .*joint3.*; fix that first, and run again the '
        'cell that starts or builds the node: the callback ended there',
    ),
    (ReportsNumbers, NO_FEEDBACK),
    (ReportsAResult, NO_FEEDBACK),
    (
        SucceedsWithTheResult,
        r'so call it without an argument, and return the result: .*MoveArm\.Result\(.*\); fix',
    ),
    (SleepsWithAsyncio, 'no running event loop.*, so wait without asyncio, .*; fix that first, '),
    (NeverExecutes, r'a handle_accepted_callback calls goal_handle.execute\(\)'),
    (WaitsForItsOwnTimer, "the execute callback keeps the node's only thread: wait with"),
    (NeverEnds, 'end the loop of the execute callback when the arm is there'),
]


@pytest.mark.parametrize(('node_class', 'message'), NOWHERE)
def test_an_arm_that_gets_nowhere_fails_with_the_cause(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        reaches(action('/move_arm', MoveArm))


@pytest.mark.parametrize(
    ('node_class', 'message'),
    [
        (RaisesInExecute, 'the execute callback raised an exception .*joint3'),
        (FlagStuck, 'see that the node knows that the arm moves no longer'),
    ],
)
def test_a_goal_of_another_client_before_the_check_is_known(run, node_class, message):
    run(node_class)
    user = run(Node, 'user')
    client = ActionClient(user, MoveArm, '/move_arm')
    assert client.wait_for_server(timeout_sec=20.0)
    sent = client.send_goal_async(MoveArm.Goal(position=[0.1, 0.1], speed=1.0))
    wait_until(sent.done, timeout_sec=20.0)
    ended = sent.result().get_result_async()
    wait_until(ended.done, timeout_sec=20.0)
    client.destroy()
    with pytest.raises(CheckFailed, match=message):
        reaches(action('/move_arm', MoveArm))


def test_a_later_check_reports_an_earlier_exception_too(run):
    run(RaisesInExecute)
    for check in CHECKS[:2]:
        with pytest.raises(CheckFailed, match=r'the execute callback raised .*joint3'):
            check(action('/move_arm', MoveArm))
