"""A node that calls a service passes with each correct way; a second server fails it."""

import collections
import threading
import time

import pytest
from geometry_msgs.msg import Point
from ik_clients import TARGETS, IKClient, check_asks, check_never_blocks, server
from my_robot_basics.checks import CheckFailed, ik, topic
from my_robot_basics.checks.services import elbow_up, responses, servers
from my_robot_basics.graph.watcher import Watcher
from nodes.running import STOPS, imported, running
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from arm_interfaces.srv import SolveIK


class Base(IKClient):
    """With groups: its client is in one, and its other callbacks are in another."""

    def __init__(self):
        self.group = ReentrantCallbackGroup()
        super().__init__()

    def create_client(self, *arguments):
        return super().create_client(*arguments, callback_group=self.group)

    def create_subscription(self, *arguments, **options):
        return super().create_subscription(*arguments, **{'callback_group': self.group, **options})


class Awaits(Base):
    async def ask(self, target):
        self.answer(await self.client.call_async(SolveIK.Request(target=target)))


class Blocks(Base):
    """Makes blocking calls, with enough threads and a group that allows it."""

    def __init__(self):
        super().__init__()
        executor = MultiThreadedExecutor(4, context=self.context)
        executor.add_node(self)
        STOPS.append(executor.shutdown)
        threading.Thread(target=executor.spin, daemon=True).start()

    def ask(self, target):
        if self.client.wait_for_service(10.0):
            self.answer(self.client.call(SolveIK.Request(target=target), timeout_sec=10.0))


class OwnThread(IKClient):
    """Waits in a thread that it has for that."""

    def __init__(self):
        super().__init__()
        self.targets = collections.deque()
        self.is_over = threading.Event()
        STOPS.append(self.is_over.set)
        threading.Thread(target=self.work, daemon=True).start()

    def ask(self, target):
        self.targets.append(target)

    def work(self):
        while not self.is_over.wait(0.01):
            if self.targets and self.client.service_is_ready():
                future = self.client.call_async(SolveIK.Request(target=self.targets.popleft()))
                while not future.done() and not self.is_over.wait(0.01):
                    pass
                self.answer(future.result())


class WorksOff(IKClient):
    """A queue that a timer handles, one target after the other."""

    def __init__(self):
        super().__init__()
        self.targets, self.future = collections.deque(), None
        self.create_timer(0.05, self.look)

    def ask(self, target):
        self.targets.append(target)

    def look(self):
        if self.future and self.future.done():
            self.answer(self.future.result())
            self.future = None
        if self.targets and not self.future and self.client.service_is_ready():
            self.future = self.client.call_async(SolveIK.Request(target=self.targets.popleft()))


RIGHT = [IKClient, Awaits, Blocks, OwnThread, WorksOff]


@pytest.mark.parametrize('node_class', RIGHT)
def test_each_correct_way_to_call_a_service_passes(run, node_class):
    run(node_class)
    check_asks()
    check_never_blocks()


class WorksOffSlowly(WorksOff):
    """Meets the server late, as on a busy machine: messages have been repeated by then."""

    def __init__(self):
        super().__init__()
        self.asked = 0

    def look(self):
        self.asked += 1
        if self.asked % 6 == 0:
            super().look()


@pytest.mark.slow
def test_no_request_for_a_repeated_message_is_lost_when_the_server_leaves(run, monkeypatch):
    monkeypatch.setattr(servers, 'AGAIN_SEC', 0.05)
    monkeypatch.setattr(responses, 'OWED_SEC', 1.0)
    run(WorksOffSlowly)
    check_never_blocks()
    check_never_blocks()


class LateOnce(IKClient):
    """Is late with its first target, as on a busy machine."""

    was_late = False

    def ask(self, target):
        if not self.was_late:
            self.was_late = True
            self.client.wait_for_service()  # on a busy machine the check's server may come later
            time.sleep(2.0)
        super().ask(target)


def test_a_target_from_before_the_check_that_is_handled_late_is_not_one_too_many(run):
    run(LateOnce)
    target = Point(x=TARGETS[0][0], y=TARGETS[0][1])
    with Watcher() as before:
        publisher = topic('/target_point').meet(before, Point)
        publisher.publish(target)
        before.spin_for(0.2)
    with server() as serving:
        ik.expect_answer(serving, *TARGETS[0])
        serving.expect_nothing(hint=str, made_of=elbow_up.is_elbow_up)
        assert len(serving.requests) == len(serving.published) + 1
        elbow_up.expect_no_others(serving)


@pytest.mark.slow
def test_a_node_run_as_a_separate_program_passes():
    with running('ik_client'):
        check_asks()
        check_never_blocks()


@pytest.mark.slow
def test_a_client_passes_if_the_server_answers_in_reverse_order(run):
    run(IKClient)
    with server() as serving:
        serving.hold()
        for target in TARGETS:
            ik.ask(serving, *target)
        serving.release(reverse=True)
        for target in reversed(TARGETS):
            ik.expect_elbow_up(serving, *target)


class ServesLater(IKClient):
    """Starts a server with its first request, in a node that the course's lists leave out."""

    def ask(self, target):
        self.own = Node('_own', context=self.context)
        STOPS.append(self.own.destroy_node)
        self.own.create_service(SolveIK, '/solve_ik', lambda request, response: response)
        super().ask(target)


@pytest.mark.slow
@pytest.mark.parametrize('check', [check_asks, check_never_blocks])
def test_a_second_server_that_appears_later_fails_the_check(run, check):
    run(ServesLater)
    with pytest.raises(CheckFailed, match='no server of /solve_ik but that of this check, saw on'):
        check()


@pytest.mark.slow
def test_a_second_server_is_named(run):
    run(IKClient)
    run(imported('ik_service').IKService)
    words = (
        r"/solve_ik but that of this check, saw /ik_service: .* with stop\('/ik_service'\) in a"
    )
    with pytest.raises(CheckFailed, match=words):
        check_asks()
