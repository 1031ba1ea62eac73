"""A node that sends goals passes, however it waits for their ends."""

import collections
import threading
import time

import pytest
from goal_clients import ENDS, WORDS, MoveArmClient, check_cancels, check_outcomes
from my_robot_basics.checks import CheckFailed, action_server, replies
from my_robot_basics.checks.actions import client_nodes, served_action
from nodes.running import STOPS, imported, running
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from sensor_msgs.msg import JointState

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer


class Lambdas(MoveArmClient):
    """Publishes each outcome at once, with lambdas."""

    def answered(self, future):
        handle = future.result()
        if handle.accepted:
            self.goal_handle = handle
            result = handle.get_result_async()
            result.add_done_callback(lambda done: self.tell(WORDS[done.result().status]))
        else:
            self.tell('rejected')


class Awaits(MoveArmClient):
    """One coroutine from the goal to its end, in a group that lets others run."""

    def __init__(self):
        self.group = ReentrantCallbackGroup()
        super().__init__()

    def create_subscription(self, *arguments, **options):
        return super().create_subscription(*arguments, callback_group=self.group, **options)

    async def send(self, pose):
        handle = await self.client.send_goal_async(MoveArm.Goal(position=pose.position, speed=0.5))
        if not handle.accepted:
            return self.tell('rejected')
        self.goal_handle = handle
        response = await handle.get_result_async()
        self.tell(WORDS[response.status])


class Blocks(Awaits):
    """Makes blocking calls, with enough threads."""

    def __init__(self):
        super().__init__()
        executor = MultiThreadedExecutor(6, context=self.context)
        executor.add_node(self)
        STOPS.append(executor.shutdown)
        threading.Thread(target=executor.spin, daemon=True).start()

    def send(self, pose):
        goal = MoveArm.Goal(position=pose.position, speed=0.5)
        future = self.client.send_goal_async(goal)
        if not self.has(future):
            return
        if not future.result().accepted:
            self.tell('rejected')
            return
        self.goal_handle = future.result()
        result = self.goal_handle.get_result_async()
        if self.has(result):
            self.tell(WORDS[result.result().status])

    def has(self, future):
        end = time.monotonic() + 20.0
        while not future.done() and time.monotonic() < end and self.context.ok():
            time.sleep(0.01)
        return future.done()


class Queue(MoveArmClient):
    """A timer that handles a queue of received poses."""

    def __init__(self):
        super().__init__()
        self.poses = collections.deque()
        self.create_timer(0.05, self.look)

    def send(self, pose):
        self.poses.append(pose)

    def look(self):
        while self.poses and self.client.server_is_ready():
            super().send(self.poses.popleft())


class RepublishesFeedback(MoveArmClient):
    def send(self, pose):
        goal = MoveArm.Goal(position=pose.position, speed=0.5)
        sent = self.client.send_goal_async(goal, feedback_callback=lambda _: None)
        sent.add_done_callback(self.answered)


RIGHT = [
    MoveArmClient,
    Lambdas,
    Awaits,
    Blocks,
    Queue,
    RepublishesFeedback,
]


@pytest.mark.parametrize('node_class', RIGHT)
def test_each_correct_way_to_send_goals_passes(run, node_class):
    run(node_class)
    check_outcomes()
    check_cancels()


def test_an_earlier_obstacle_is_handled_before_the_next_goal_is_published(run, monkeypatch):
    """Two topics have no common order: the goal may be accepted before the obstacle arrives."""
    happened = []

    def note(owner, name):
        function = getattr(owner, name)

        def noted(*arguments, **options):
            happened.append(name)
            return function(*arguments, **options)

        monkeypatch.setattr(owner, name, noted)

    note(served_action.ServedAction, 'say_obstacle')
    note(served_action.ServedAction, 'publish')
    note(client_nodes, 'answers_parameters')
    run(MoveArmClient)
    with action_server('/move_arm', MoveArm, **ENDS) as server:
        replies.expect_no_cancel(server, (-0.3, 0.9))
    assert happened[:3] == ['say_obstacle', 'answers_parameters', 'publish']


class SendsAnEarlierGoalLate(MoveArmClient):
    """Sends with the first pose a goal that a server missed, as one does that waited for it."""

    has_sent = False

    def send(self, pose):
        if not self.has_sent:
            self.has_sent = True
            super().send(JointState(position=[0.1, 0.1]))
        super().send(pose)


def test_the_outcome_of_an_earlier_goal_may_come_late(run):
    run(SendsAnEarlierGoalLate)
    with action_server('/move_arm', MoveArm, **ENDS) as server:
        replies.expect_outcomes(server, aborted=(1.2, -0.6))


@pytest.mark.slow
def test_a_node_run_as_a_separate_program_passes():
    with running('move_arm_client'):
        check_outcomes()
        check_cancels()


def test_a_second_action_server_fails_the_check(run):
    run(MoveArmClient)
    run(MoveArmServer)
    words = r"saw /move_arm_server: stop that node, with stop\('/move_arm_server'\) in a cell"
    with pytest.raises(CheckFailed, match=words):
        check_outcomes()
