"""The traceback of an action's execute callback appears once, not with each goal of a check."""

import time

import pytest
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node

from arm_interfaces.action import MoveArm

pytestmark = pytest.mark.starts

TIMEOUT_SEC = 20.0


class Raiser(Node):
    """Its execute callback raises at one of two lines."""

    def __init__(self):
        super().__init__('raiser')
        ActionServer(self, MoveArm, '/raise', self.execute)

    async def execute(self, goal_handle):
        if goal_handle.request.speed > 1.0:
            goal_handle.suceed()
        goal_handle.succed()


def send(node, *speeds):
    """Send a goal with each speed, one after the other, and wait until each has ended."""
    client = ActionClient(node, MoveArm, '/raise')
    assert client.wait_for_server(timeout_sec=TIMEOUT_SEC)
    for speed in speeds:
        handle = result_of(client.send_goal_async(MoveArm.Goal(speed=speed)))
        result_of(handle.get_result_async())
    client.destroy()


def result_of(future):
    deadline = time.monotonic() + TIMEOUT_SEC
    while not future.done():
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return future.result()


def test_each_line_that_raises_has_one_traceback_in_each_run(run, capsys):
    user = run(Node, 'user')
    for _ in range(2):  # the cell that starts the node runs twice
        run(Raiser)
        send(user, 0.0, 0.0, 2.0, 0.0, 2.0)
        printed = capsys.readouterr().err
        assert printed.count('Traceback') == 2
        assert printed.count("has no attribute 'succed'") == 1
        assert printed.count("has no attribute 'suceed'") == 1
