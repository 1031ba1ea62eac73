"""A client that waits for the answer, or for the server, blocks itself, and the check says so."""

import time

import pytest
import rclpy
from geometry_msgs.msg import Point
from ik_clients import IKClient, check_asks, check_never_blocks, server
from my_robot_basics.checks import CheckFailed, ik, topic
from my_robot_basics.checks.services import servers
from my_robot_basics.graph.watcher import Watcher
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup

from arm_interfaces.srv import SolveIK


@pytest.fixture
def impatient(monkeypatch):
    """Shorten the waits for messages that never come."""
    monkeypatch.setattr(servers, 'TIMEOUT_SEC', 1.5)


WAITS = (
    "it called `/solve_ik` inside a callback and waited there: the answer can't be delivered "
    'while the callback runs, or while all threads of its executor wait like this; use '
    'call_async and add_done_callback, or `await` with the callback and the client in one '
    'ReentrantCallbackGroup'
)


class Calls(IKClient):
    def ask(self, target):
        self.answer(self.client.call(SolveIK.Request(target=target), timeout_sec=20.0))


class CallsAWhile(IKClient):
    def ask(self, target):
        self.answer(self.client.call(SolveIK.Request(target=target), timeout_sec=3.0))


@pytest.mark.slow
def test_a_request_delayed_by_waiting_in_a_callback_fails_with_the_cause(run):
    run(CallsAWhile)
    with Watcher() as here:
        publisher = topic('/target_point').meet(here, Point)
        for tenths in range(1, 10):  # it waits 3 s for each: there is a server before the last
            publisher.publish(Point(x=tenths / 10, y=0.7))
    with server() as serving:
        serving.hold()
        with pytest.raises(CheckFailed, match=r'saw .*x=0\.[1-9].*: it waits inside a callback'):
            ik.ask(serving, 1.2, 0.8)


class SpinsInside(IKClient):
    def ask(self, target):
        future = self.client.call_async(SolveIK.Request(target=target))
        rclpy.spin_until_future_complete(self, future, timeout_sec=20.0)
        self.answer(future.result())


class Sleeps(IKClient):
    def ask(self, target):
        future = self.client.call_async(SolveIK.Request(target=target))
        for _ in range(200):
            if future.done():
                break
            time.sleep(0.1)
        else:
            return
        self.answer(future.result())


class AwaitsInItsOnlyGroup(IKClient):
    async def ask(self, target):
        self.answer(await self.client.call_async(SolveIK.Request(target=target)))


@pytest.mark.parametrize('node_class', [Calls, SpinsInside, AwaitsInItsOnlyGroup])
@pytest.mark.usefixtures('impatient')
def test_waiting_inside_a_callback_fails_with_the_cause(run, node_class):
    run(node_class)
    with pytest.raises(CheckFailed) as failure:
        check_never_blocks()
    assert str(failure.value) == (
        'expected the count on /ik_client/alive to go on while the server takes its time, '
        f'saw it stand still: {WAITS}'
    )


@pytest.mark.usefixtures('impatient')
def test_sleeping_until_the_answer_comes_fails_with_the_line(run):
    run(Sleeps)
    with pytest.raises(CheckFailed, match=r'it sleeps inside a callback \(line \d+: time.sleep'):
        check_never_blocks()


@pytest.mark.parametrize('node_class', [Calls, SpinsInside])
@pytest.mark.usefixtures('impatient')
def test_a_client_that_never_gets_an_answer_fails_with_the_cause(run, node_class):
    run(node_class)
    with pytest.raises(CheckFailed, match=r'expected the elbow-up pose .*saw none') as failure:
        check_asks()
    assert str(failure.value).endswith(WAITS)


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_a_client_that_gives_up_waiting_fails_for_its_wait(run):
    run(CallsAWhile)
    for check in check_asks, check_never_blocks:
        with pytest.raises(CheckFailed, match='inside a callback'):
            check()


class WaitsForTheServer(IKClient):
    def ask(self, target):
        self.client.wait_for_service(20.0)
        super().ask(target)


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_waiting_for_an_absent_server_fails_with_the_cause(run):
    run(WaitsForTheServer)
    check_asks()
    with pytest.raises(CheckFailed, match='while there is no server, saw it stand still: it wai'):
        check_never_blocks()


class CountsAhead(WaitsForTheServer):
    def ask(self, target):
        if not self.client.service_is_ready():
            for _ in range(100):
                self.say_alive()
        super().ask(target)


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_counting_ahead_does_not_hide_a_wait_for_the_server(run):
    run(CountsAhead)
    with pytest.raises(CheckFailed, match='while there is no server, saw it stand still'):
        check_never_blocks()


class HasNoTimer(IKClient):
    def say_alive(self):
        pass


def test_a_client_whose_counter_does_not_run_is_not_said_to_wait(run):
    run(HasNoTimer)
    with pytest.raises(CheckFailed) as failure:
        check_never_blocks()
    assert str(failure.value) == (
        'expected the count on /ik_client/alive to go on while the server takes its time, saw it '
        'stand still: the node waits for nothing, and still no timer publishes on '
        '/ik_client/alive: leave that one as it was given, with its period of 0.1 s'
    )


class AwaitsInTheGroupOfItsCounter(AwaitsInItsOnlyGroup):
    def create_subscription(self, *args, **kwargs):
        self.group = MutuallyExclusiveCallbackGroup()
        return super().create_subscription(*args, callback_group=self.group, **kwargs)

    def create_timer(self, *args, **kwargs):
        return super().create_timer(*args, callback_group=self.group, **kwargs)


def test_a_client_that_waits_in_the_group_of_its_counter_is_said_to_wait(run):
    run(AwaitsInTheGroupOfItsCounter)
    with pytest.raises(CheckFailed, match='called `/solve_ik` inside a callback and waited there'):
        check_never_blocks()


class OnlyAsks(HasNoTimer):
    def answer(self, response):
        pass


class OnlyListens(HasNoTimer):
    def ask(self, target):
        pass


@pytest.mark.parametrize(
    ('node_class', 'hint'),
    [
        (OnlyAsks, 'publish when the answer is there, however late it comes'),
        (OnlyListens, r'call self\.client\.call_async\(request\) for each message'),
    ],
)
@pytest.mark.usefixtures('impatient')
def test_a_missing_answer_of_a_client_without_counter_has_its_own_reason(run, node_class, hint):
    run(node_class)
    with pytest.raises(CheckFailed, match=f'saw none in 1.5 s: {hint}'):
        check_asks()


class DropsMeanwhile(IKClient):
    is_busy = False

    def ask(self, target):
        if not self.is_busy:
            self.is_busy = True
            super().ask(target)

    def answer(self, response):
        self.is_busy = False
        super().answer(response)


class RemembersOneFuture(IKClient):
    future = None

    def __init__(self):
        super().__init__()
        self.create_timer(0.05, self.look)

    def ask(self, target):
        self.future = self.client.call_async(SolveIK.Request(target=target))

    def look(self):
        if self.future and self.future.done():
            future, self.future = self.future, None
            self.answer(future.result())


@pytest.mark.parametrize(
    ('node_class', 'message'),
    [
        (DropsMeanwhile, 'ask for each target, also for one that comes while the answer to'),
        (RemembersOneFuture, 'publish for each answer, though two requests are under way'),
    ],
)
@pytest.mark.usefixtures('impatient')
def test_losing_a_target_while_the_server_is_slow_fails_with_advice(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_never_blocks()


class AsksForAnotherPoint(IKClient):
    def ask(self, target):
        super().ask(Point(x=abs(target.x), y=target.y))


@pytest.mark.usefixtures('impatient')
def test_asking_for_another_point_fails_with_advice_about_the_request(run):
    run(AsksForAnotherPoint)
    with pytest.raises(CheckFailed, match=r'put the point that arrived into request\.target'):
        check_never_blocks()
