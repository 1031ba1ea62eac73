"""A response that another thread takes before its request is noted still arrives."""

import threading
import time
from types import SimpleNamespace

import pytest
from my_robot_basics.live.nodes import runner
from my_robot_basics.live.nodes.destroying import destroy
from my_robot_basics.live.patches import action_requests
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from arm_interfaces.action import MoveArm

pytestmark = pytest.mark.starts

LATE_SEC = 0.3
"""How long a thread gets no processor between sending and noting."""
TIMEOUT_SEC = 20.0


class LateHandle:
    """The handle of a client whose thread is held up after it has sent a request."""

    def __init__(self, handle):
        self.handle = handle

    def __getattr__(self, name):
        found = getattr(self.handle, name)
        if not name.startswith('send_'):
            return found

        def send_and_be_late(request):
            number = found(request)
            time.sleep(LATE_SEC)
            return number

        return send_and_be_late

    def __enter__(self):
        return self.handle.__enter__()

    def __exit__(self, *error):
        return self.handle.__exit__(*error)


class Mover(Node):
    """Serves an action whose goals end when they are cancelled or told to, and is its client."""

    def __init__(self):
        super().__init__('mover')
        group = ReentrantCallbackGroup()
        self.may_end = threading.Event()
        self.server = ActionServer(
            self,
            MoveArm,
            '/move',
            self.execute,
            cancel_callback=lambda goal: CancelResponse.ACCEPT,
            callback_group=group,
        )
        self.client = ActionClient(self, MoveArm, '/move', callback_group=group)

    def execute(self, goal_handle):
        """Wait until the test says how to go on."""
        self.may_end.wait(TIMEOUT_SEC)
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.succeed()
        return MoveArm.Result()


@pytest.fixture
def mover():
    runner.set_up()
    runner.ensure_rclpy()
    node, executor = Mover(), MultiThreadedExecutor(4)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    assert node.client.wait_for_server(TIMEOUT_SEC)
    node.client._client_handle = LateHandle(node.client._client_handle)
    yield node
    node.may_end.set()
    executor.shutdown()
    thread.join()
    destroy(node)


def result_of(future):
    """Return the result of a future that an executor's thread sets."""
    is_done = threading.Event()
    future.add_done_callback(lambda _: is_done.set())
    assert is_done.wait(TIMEOUT_SEC), 'the response was lost'
    return future.result()


def test_responses_to_a_goal_a_cancel_request_and_a_result_request_arrive(mover):
    goal = result_of(mover.client.send_goal_async(MoveArm.Goal()))
    assert goal.accepted
    assert len(result_of(goal.cancel_goal_async()).goals_canceling) == 1
    mover.may_end.set()
    assert result_of(goal.get_result_async()).result == MoveArm.Result()


def test_a_lock_that_stays_taken_keeps_no_response_back(monkeypatch):
    """An interrupt may leave it so."""
    monkeypatch.setattr(action_requests, '_NOTED_SEC', 0.01)
    take_data = action_requests._after_requests(lambda client: {'goal': client})
    client = SimpleNamespace()
    action_requests._lock_of(client).acquire()
    assert take_data(client) == {'goal': client}
