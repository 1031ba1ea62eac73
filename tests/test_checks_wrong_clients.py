"""If a client requests or publishes the wrong thing, the check says what."""

from functools import partial

import pytest
from geometry_msgs.msg import Point
from ik_clients import TARGETS, IKClient, check_asks, check_never_blocks, server
from my_robot_basics.checks import CheckFailed, ik
from my_robot_basics.checks.services import holding_server, servers
from std_srvs.srv import Trigger

from arm_interfaces.srv import SolveIK


@pytest.fixture
def impatient(monkeypatch):
    """Shorten the waits for messages that never come."""
    monkeypatch.setattr(servers, 'TIMEOUT_SEC', 1.5)


class ForwardsNothing(IKClient):
    def answer(self, response):
        pass


class ElbowDown(IKClient):
    def answer(self, response):
        self.send(response.elbow_down)


class Degrees(IKClient):
    def send(self, position):
        super().send([57.29577951308232 * angle for angle in position])


class Rounds(IKClient):
    def send(self, position):
        super().send([round(angle, 2) for angle in position])


class AsksForAnother(IKClient):
    def ask(self, target):
        super().ask(Point(x=target.y, y=target.x))


class AsksNobody(IKClient):
    def ask(self, target):
        pass


class RaisesInAnswer(IKClient):
    def answer(self, response):
        self.send(response.elbow)


class SkipsRepeatedPoses(IKClient):
    last = None

    def send(self, position):
        if position != self.last:
            super().send(position)
        self.last = position


class RaisesInSecondAnswer(IKClient):
    def __init__(self):
        super().__init__()
        self.names = ['first']

    def answer(self, response):
        self.get_logger().info(self.names.pop())
        super().answer(response)


WRONG = [
    (ForwardsNothing, 'saw none in 1.5 s: publish when the answer is there'),
    (ElbowDown, 'this is elbow_down: publish the angles of response.elbow_up'),
    (Degrees, 'these are degrees: publish the angles of response.elbow_up as they are'),
    (Rounds, 'publish the angles of response.elbow_up as they are: they are in radians'),
    (AsksForAnother, 'a request to /solve_ik for the message on /target_point, saw arm_interf'),
    (AsksNobody, 'saw none in 1.5 s: call self.client.call_async'),
    (RaisesInAnswer, "saw none in 1.5 s: its callback raised AttributeError.*'elbow'"),
    (SkipsRepeatedPoses, 'publish each answer once, also if it equals an earlier one'),
    (RaisesInSecondAnswer, 'saw none in 1.5 s: its callback raised IndexError'),
]


class Solves(IKClient):
    def ask(self, target):
        self.target = target
        super().ask(target)

    def answer(self, response):
        super().answer(ik.solve(SolveIK.Request(target=self.target)))


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_a_client_that_publishes_its_own_solution_instead_of_the_response_fails(run):
    run(Solves)
    with (
        server(partial(ik.solve, l1=1.3)) as serving,
        pytest.raises(CheckFailed, match='the angles of the response, not a solution of'),
    ):
        ik.expect_answer(serving, *TARGETS[0])


class KeepsTheLatest(IKClient):
    """Asks for one target after the other; of those that wait, it keeps only the latest."""

    def __init__(self):
        super().__init__()
        self.waiting, self.is_busy = None, False

    def ask(self, target):
        if not self.client.service_is_ready():
            return
        if self.is_busy:
            self.waiting = target
            return
        self.is_busy = True
        super().ask(target)

    def answer(self, response):
        self.is_busy = False
        super().answer(response)
        target, self.waiting = self.waiting, None
        if target:
            self.ask(target)


@pytest.mark.usefixtures('impatient')
def test_a_client_that_keeps_only_the_latest_of_its_waiting_targets_is_reported(run):
    run(KeepsTheLatest)
    check_asks()
    with pytest.raises(CheckFailed, match='ask for each target, also for one that comes while'):
        check_never_blocks()


class CountsSlowly(IKClient):
    """A count that its student has slowed down, from ten times a second to once."""

    def __init__(self):
        super().__init__()
        self.calls = 0

    def say_alive(self):
        self.calls += 1
        if self.calls % 10 == 0:
            super().say_alive()


def test_a_slow_count_is_reported_as_a_wrong_rate_and_not_as_blocking(run):
    run(CountsSlowly)
    with pytest.raises(
        CheckFailed, match=r'expected 10.0 Hz on /ik_client/alive, saw .* 1 / rate'
    ):
        check_never_blocks()


class AnswersAnything(IKClient):
    def answer(self, response):
        self.send(response.elbow_up)


@pytest.mark.slow
@pytest.mark.usefixtures('impatient')
def test_publishing_without_angles_for_an_unreachable_target_is_reported(run):
    run(AnswersAnything)
    with pytest.raises(CheckFailed, match=r'no message on /kin.*: publish only if response.re'):
        check_asks()


@pytest.mark.parametrize(('node_class', 'message'), WRONG)
@pytest.mark.usefixtures('impatient')
def test_each_wrong_client_is_reported_with_its_fault(run, node_class, message):
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
def test_a_client_that_publishes_more_than_the_response_is_reported(run, node_class, hint):
    run(node_class)
    with pytest.raises(CheckFailed, match=f'{ANOTHER}.*{hint}'):
        check_never_blocks()


@pytest.mark.slow
def test_a_client_that_publishes_twice_fails_the_check_of_its_requests(run):
    run(Twice)
    with pytest.raises(CheckFailed, match='/kinematics/joint_states'):
        check_asks()


class AsksForTheLastTarget(IKClient):
    """Requests the last target twice a second, once there is one."""

    def __init__(self):
        super().__init__()
        self.target = None
        self.create_timer(0.5, lambda: self.target and super(type(self), self).ask(self.target))

    def ask(self, target):
        self.target = target
        super().ask(target)


@pytest.mark.slow
def test_a_client_that_publishes_the_pose_of_a_target_repeatedly_is_reported(run):
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
def test_a_client_with_endless_requests_is_stopped_at_a_limit(run, monkeypatch):
    monkeypatch.setattr(holding_server, 'MOST_REQUESTS', 20)
    run(AsksAgain)
    with pytest.raises(CheckFailed, match=r'for each message, saw 20 of them: ask once in the'):
        check_never_blocks()


class AsksInALoop(IKClient):
    """Sends more requests for each target than its queue can hold responses."""

    def ask(self, target):
        for _ in range(holding_server.MOST_HELD):
            self.client.call_async(SolveIK.Request(target=target))
        super().ask(target)


@pytest.mark.slow
def test_a_client_that_sends_more_requests_than_its_queue_holds_is_reported(run):
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
def test_a_client_of_a_different_service_or_type_is_reported(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_asks()
