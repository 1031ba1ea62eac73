"""A node that asks a service: right in whatever way, and told the cause where it waits."""

import collections
import threading
import time
from functools import partial

import pytest
import rclpy
from geometry_msgs.msg import Point
from my_robot_basics.checks import (
    CheckFailed,
    holding_server,
    ik,
    responses,
    serve,
    servers,
    topic,
)
from my_robot_basics.graph.watcher import Watcher
from nodes.running import imported, running
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

from arm_interfaces.srv import SolveIK
from my_robot_basics import live

IKClient = imported('ik_client').IKClient

TARGETS = [(1.2, 0.4), (-0.5, 1.1), (0.9, -1.3)]
WAITS = (
    "it called `/solve_ik` inside a callback and waited there: the answer can't be delivered "
    'while the callback runs, or while all threads of its executor wait like this; use '
    'call_async and add_done_callback'
)
STOPS = []
"""What ends the threads that nodes have made for themselves."""


@pytest.fixture
def run():
    yield live.run
    while STOPS:
        STOPS.pop()()
    live.stop()


@pytest.fixture
def impatient(monkeypatch):
    """Wait for what does not come no longer than it takes to be sure."""
    monkeypatch.setattr(servers, 'TIMEOUT_SEC', 1.5)


def server(answer=ik.solve):
    return serve(
        '/solve_ik',
        SolveIK,
        answer,
        asked_on='/target_point',
        to='/kinematics/joint_states',
        alive='/ik_client/alive',
    )


def check_asks():
    with server() as serving:
        for target in TARGETS:
            ik.expect_answer(serving, *target)
        ik.expect_no_answer(serving, 2.5, 0.0)


def check_never_blocks():
    with server() as serving:
        ik.expect_never_blocks(serving, *TARGETS)


# --- right ones ----------------------------------------------------------------------------------


class Base(IKClient):
    """With groups: what it asks is in one, and its other callbacks are in another."""

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
    """Calls and waits, with threads enough and a group that allows it."""

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
    """A queue that a timer works off, one after the other."""

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
def test_who_asks_right_passes_in_whatever_way(run, node_class):
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


@pytest.mark.slow
def test_a_program_of_its_own_passes():
    with running('ik_client'):
        check_asks()
        check_never_blocks()


@pytest.mark.slow
def test_answers_come_out_of_order_where_the_server_says_so(run):
    run(IKClient)
    with server() as serving:
        serving.hold()
        for target in TARGETS:
            ik.ask(serving, *target)
        serving.release(reverse=True)
        for target in reversed(TARGETS):
            ik.expect_elbow_up(serving, *target)


# --- who waits -----------------------------------------------------------------------------------


class Calls(IKClient):
    def ask(self, target):
        self.answer(self.client.call(SolveIK.Request(target=target), timeout_sec=20.0))


class CallsAWhile(IKClient):
    def ask(self, target):
        self.answer(self.client.call(SolveIK.Request(target=target), timeout_sec=3.0))


@pytest.mark.slow
def test_who_waits_and_asks_late_for_what_came_before_is_told_of_the_wait(run):
    run(CallsAWhile)
    with Watcher() as here:
        publisher = topic('/target_point').meet(here, Point)
        for x in 0.7, 0.8, 0.9:
            publisher.publish(Point(x=x, y=0.7))
    with server() as serving:
        serving.hold()
        with pytest.raises(CheckFailed, match=r'saw .*x=0\.[789].*: it waits inside a callback'):
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


WAITING = [Calls, SpinsInside, Sleeps, AwaitsInItsOnlyGroup]


@pytest.mark.parametrize('node_class', WAITING)
@pytest.mark.usefixtures('impatient')
def test_who_waits_inside_a_callback_is_told(run, node_class):
    run(node_class)
    with pytest.raises(CheckFailed) as failure:
        check_never_blocks()
    assert str(failure.value) == (
        'expected the count on /ik_client/alive to go on while the server takes its time, '
        f'saw it stand still: {WAITS}'
    )


@pytest.mark.parametrize('node_class', [Calls, SpinsInside])
@pytest.mark.usefixtures('impatient')
def test_who_never_gets_an_answer_is_told_why(run, node_class):
    run(node_class)
    with pytest.raises(CheckFailed, match=r'expected the elbow-up pose .*saw none') as failure:
        check_asks()
    assert str(failure.value).endswith(WAITS)


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_who_gives_up_waiting_is_told_not_to_wait(run):
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
def test_who_waits_for_a_server_that_is_not_there_is_told(run):
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
def test_who_counts_ahead_has_to_go_on_all_the_same(run):
    run(CountsAhead)
    with pytest.raises(CheckFailed, match='while there is no server, saw it stand still'):
        check_never_blocks()


# --- who is wrong otherwise ----------------------------------------------------------------------


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
def test_who_loses_a_target_while_the_server_takes_its_time_is_told(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_never_blocks()


class ForwardsNothing(IKClient):
    def answer(self, response):
        pass


class ElbowDown(IKClient):
    def answer(self, response):
        self.send(response.elbow_down)


class Degrees(IKClient):
    def send(self, position):
        super().send([57.29577951308232 * angle for angle in position])


class AsksForAnother(IKClient):
    def ask(self, target):
        super().ask(Point(x=target.y, y=target.x))


class AsksNobody(IKClient):
    def ask(self, target):
        pass


class RaisesInAnswer(IKClient):
    def answer(self, response):
        self.send(response.elbow)


WRONG = [
    (ForwardsNothing, 'saw none in 1.5 s: publish when the answer is there'),
    (ElbowDown, 'this is elbow_down: publish the angles of response.elbow_up'),
    (Degrees, 'these are degrees: convert both with radians'),
    (AsksForAnother, 'a request to /solve_ik for the message on /target_point, saw arm_interf'),
    (AsksNobody, 'saw none in 1.5 s: call self.client.call_async'),
    (RaisesInAnswer, "saw none in 1.5 s: its callback raised AttributeError.*'elbow'"),
]


class Solves(IKClient):
    def ask(self, target):
        self.target = target
        super().ask(target)

    def answer(self, response):
        super().answer(ik.solve(SolveIK.Request(target=self.target)))


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_who_asks_and_publishes_another_answer_is_found(run):
    run(Solves)
    with (
        server(partial(ik.solve, l1=1.3)) as serving,
        pytest.raises(CheckFailed, match='the angles of the response, not a solution of'),
    ):
        ik.expect_answer(serving, *TARGETS[0])


class AnswersAnything(IKClient):
    def answer(self, response):
        self.send(response.elbow_up)


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_who_publishes_no_angles_is_told(run):
    run(AnswersAnything)
    with pytest.raises(CheckFailed, match=r'no message on /kin.*: publish only where response.re'):
        check_asks()


@pytest.mark.parametrize(('node_class', 'message'), WRONG)
@pytest.mark.usefixtures('impatient')
def test_what_is_wrong_is_named(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_asks()


class SolvesAtOnce(IKClient):
    def ask(self, target):
        super().ask(target)
        self.send(ik.solve(SolveIK.Request(target=target)).elbow_up)

    def answer(self, response):
        pass


class BothBranches(IKClient):
    def answer(self, response):
        for position in (response.elbow_down, response.elbow_up):
            super().send(position)


class Twice(IKClient):
    def send(self, position):
        for _ in range(2):
            super().send(position)


ANOTHER = r'expected one message on /kinematics/joint_states for each response, and no other, saw '


@pytest.mark.parametrize(
    ('node_class', 'hint'),
    [
        (SolvesAtOnce, 'publish the angles of the response, not a solution of your own'),
        (BothBranches, 'this is elbow_down: publish the angles of response.elbow_up alone'),
        (Twice, 'publish the angles of the response, not a solution of your own, and once'),
    ],
)
def test_who_publishes_more_than_the_response_is_told(run, node_class, hint):
    run(node_class)
    with pytest.raises(CheckFailed, match=f'{ANOTHER}.*{hint}'):
        check_never_blocks()


@pytest.mark.slow
def test_who_publishes_more_is_found_before_the_end(run):
    run(Twice)
    with pytest.raises(CheckFailed, match='/kinematics/joint_states'):
        check_asks()


class AsksForTheLastTarget(IKClient):
    """Twice a second, once there is one."""

    def __init__(self):
        super().__init__()
        self.target = None
        self.create_timer(0.5, lambda: self.target and super(type(self), self).ask(self.target))

    def ask(self, target):
        self.target = target
        super().ask(target)


@pytest.mark.slow
def test_who_asks_again_and_publishes_each_answer_is_told(run):
    run(AsksForTheLastTarget)
    with pytest.raises(
        CheckFailed, match=r'expected the pose of each target once, saw one \d tim'
    ):
        check_never_blocks()


class AsksAgain(IKClient):
    """Asks a hundred times a second, whether anything has arrived or not."""

    def __init__(self):
        super().__init__()
        self.create_timer(0.01, lambda: self.ask(Point(x=1.2, y=0.4)))


@pytest.mark.slow
def test_who_asks_without_end_is_stopped(run, monkeypatch):
    monkeypatch.setattr(holding_server, 'MOST_REQUESTS', 20)
    run(AsksAgain)
    with pytest.raises(CheckFailed, match=r'for each message, saw 20 of them: ask once in the'):
        check_never_blocks()


class AsksInALoop(IKClient):
    """Asks for each target more often than its queue can hold answers."""

    def ask(self, target):
        for _ in range(holding_server.MOST_HELD):
            self.client.call_async(SolveIK.Request(target=target))
        super().ask(target)


@pytest.mark.slow
def test_who_asks_for_more_than_its_queue_holds_is_told_so_each_time(run):
    run(AsksInALoop)
    with pytest.raises(CheckFailed, match='for each message, saw more than 10 at once: ask once'):
        check_never_blocks()


class AsksElsewhere(IKClient):
    def create_client(self, type_, name):
        return super().create_client(type_, '/solve_it')


class AsksForATrigger(IKClient):
    def create_client(self, type_, name):
        return super().create_client(Trigger, name)

    def ask(self, target):
        self.client.call_async(Trigger.Request())


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'message'),
    [
        (AsksElsewhere, '/ik_client uses /solve_it, so compare the spelling'),
        (AsksForATrigger, 'it asks for std_srvs/srv/Trigger, so compare the type in'),
    ],
)
@pytest.mark.usefixtures('impatient')
def test_a_client_of_something_else_is_found(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_asks()


class ServesLater(IKClient):
    """Brings a server along once it is asked, in a node that no list of the course's has."""

    def ask(self, target):
        self.own = Node('_own', context=self.context)
        STOPS.append(self.own.destroy_node)
        self.own.create_service(SolveIK, '/solve_ik', lambda request, response: response)
        super().ask(target)


@pytest.mark.slow
@pytest.mark.parametrize('check', [check_asks, check_never_blocks])
def test_a_server_that_comes_later_is_found(run, check):
    run(ServesLater)
    with pytest.raises(CheckFailed, match='no server of /solve_ik but that of this check, saw on'):
        check()


@pytest.mark.slow
def test_another_server_is_named(run):
    run(IKClient)
    run(imported('ik_service').IKService)
    with pytest.raises(
        CheckFailed, match='no server of /solve_ik but that of this check, saw /ik'
    ):
        check_asks()
