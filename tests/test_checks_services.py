"""A node that serves is judged by its responses; if it gives none, the check names the cause."""

import math
import threading
import time

import pytest
from my_robot_basics.checks import CheckFailed, ik, service
from my_robot_basics.checks.services import awaited_servers, services
from my_robot_basics.session.errors import NotRunnable
from nodes.running import imported, running
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

from arm_interfaces.srv import SolveIK
from my_robot_basics import live

IKService = imported('ik_service').IKService

solve_ik = service('/solve_ik', SolveIK)
TARGETS = [(1.2, 0.4), (-0.5, 1.1), (0.9, -1.3)]
OUT_OF_REACH = [(2.5, 0.0), (0.05, 0.0), (math.nan, 0.5), (0.5, math.inf)]


EXECUTORS, STOP = [], threading.Event()
"""Executors that nodes have made for themselves, and an event that ends a wait."""


@pytest.fixture
def run():
    STOP.clear()
    yield live.run
    STOP.set()
    while EXECUTORS:
        EXECUTORS.pop().shutdown()
    live.stop()


@pytest.fixture
def impatient(monkeypatch):
    """Shorten the waits for messages that never come."""
    monkeypatch.setattr(awaited_servers, 'SERVER_SEC', 1.0)
    monkeypatch.setattr(services, 'ANSWER_SEC', 1.0)


def check_answers():
    ik.expect_solutions(solve_ik, *TARGETS)


def check_refusals():
    ik.expect_refusals(solve_ik, *OUT_OF_REACH)
    ik.expect_solutions(solve_ik, TARGETS[0])


# --- right ones ----------------------------------------------------------------------------------


class Coroutine(IKService):
    async def solve(self, request, response):
        return super().solve(request, response)


class MakesItsOwnResponse(IKService):
    def solve(self, request, response):
        return super().solve(request, SolveIK.Response())


class Reentrant(Node):
    """Serves from a group of its own, with threads of its own."""

    def __init__(self):
        super().__init__('ik_service')
        group = ReentrantCallbackGroup()
        self.create_service(SolveIK, 'solve_ik', ik_solve, callback_group=group)
        executor = MultiThreadedExecutor(4, context=self.context)
        executor.add_node(self)
        EXECUTORS.append(executor)
        threading.Thread(target=executor.spin, daemon=True).start()


def ik_solve(request, response):
    return IKService.solve(Filler(), request, response)


class Filler:
    fill = IKService.fill


class WholeTurnsOff(IKService):
    def fill(self, response, branches_deg):
        super().fill(response, branches_deg)
        response.elbow_up = [angle + math.tau for angle in response.elbow_up]


RIGHT = [IKService, Coroutine, MakesItsOwnResponse, Reentrant, WholeTurnsOff]


@pytest.mark.parametrize('node_class', RIGHT)
def test_each_correct_service_passes(run, node_class):
    run(node_class)
    check_answers()
    check_refusals()


class AnswersOften(Node):
    """The first response is right, and 30 wrong ones follow at once."""

    def __init__(self):
        super().__init__('answers_often')
        self.server = self.create_service(Trigger, '/often', self.answer)
        self.server.send_response = self.send

    def answer(self, request, response):
        return response

    def send(self, response, header):
        with self.server.handle:
            for number in range(31):
                response = Trigger.Response(success=number == 0)
                self.server.handle.service_send_response(response, header.request_id)


def test_the_first_response_counts_even_if_the_check_looks_late(run, monkeypatch):
    wait_for_all = services.wait_for_all

    def late(*arguments, **options):
        time.sleep(1.0)  # as on a busy machine
        return wait_for_all(*arguments, **options)

    run(AnswersOften)
    monkeypatch.setattr(services, 'wait_for_all', late)
    assert service('/often', Trigger).call(Trigger.Request()).success


@pytest.mark.slow
def test_a_node_run_as_a_separate_program_passes():
    with running('ik_service'):
        check_answers()
        check_refusals()


# --- wrong answers -------------------------------------------------------------------------------


class Degrees(IKService):
    def fill(self, response, branches_deg):
        response.elbow_up, response.elbow_down = map(list, branches_deg.values())


class OneBranch(IKService):
    def fill(self, response, branches_deg):
        super().fill(response, branches_deg)
        response.elbow_down = []


class Swapped(IKService):
    def fill(self, response, branches_deg):
        super().fill(response, branches_deg)
        response.elbow_up, response.elbow_down = response.elbow_down, response.elbow_up


class JointsSwapped(IKService):
    def fill(self, response, branches_deg):
        super().fill(response, branches_deg)
        response.elbow_up = response.elbow_up[::-1]


class InThePlaneAlone(IKService):
    def solve(self, request, response):
        return response if request.target.z else super().solve(request, response)


class NotReachable(IKService):
    def fill(self, response, branches_deg):
        super().fill(response, branches_deg)
        response.reachable = False


WRONG = [
    (Degrees, r'elbow_up of \[.*\] rad for the target .*: these are degrees: convert both'),
    (OneBranch, r'elbow_down .*saw \[\]: fill in both branches: response.elbow_down is empty'),
    (Swapped, 'this is elbow_down: the two branches are swapped'),
    (JointsSwapped, 'the joints are swapped'),
    (InThePlaneAlone, 'with z = 0.7, saw False: z does not matter: look at x and y'),
    (NotReachable, r'expected reachable to be True .*saw False: set response.reachable = True'),
]


@pytest.mark.parametrize(('node_class', 'message'), WRONG)
def test_a_wrong_solution_is_named(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_answers()


class AcceptsNaN(IKService):
    def solve(self, request, response):
        if math.isfinite(request.target.x + request.target.y):
            return super().solve(request, response)
        response.reachable, response.elbow_up, response.elbow_down = True, [0.0] * 2, [0.0] * 2
        return response


class LeavesAngles(IKService):
    def solve(self, request, response):
        response.elbow_up = [0.0, 0.0]
        return super().solve(request, response)


class SaysNothing(IKService):
    def solve(self, request, response):
        response = super().solve(request, response)
        response.message = ''
        return response


class Raises(IKService):
    def solve(self, request, response):
        self.fill(response, imported('ik_service').inverse_kinematics(request.target.x, 0.0))
        response.reachable = True
        return response


REFUSED_WRONG = [
    (AcceptsNaN, r'expected reachable to be False for \(nan, 0\.5\), saw True'),
    (LeavesAngles, r'expected no angles for \(2\.5, 0\), saw 2: leave elbow_up'),
    (SaysNothing, r'expected a message that says why .*saw none: set response\.message'),
    (Raises, r'expected an answer, saw none: its callback raised ValueError.*; fix that first'),
]


@pytest.mark.parametrize(('node_class', 'message'), REFUSED_WRONG)
@pytest.mark.usefixtures('impatient')
def test_a_wrong_refusal_fails_with_its_cause(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_refusals()


# --- no answer, no server ------------------------------------------------------------------------


class ReturnsNothing(IKService):
    def solve(self, request, response):
        super().solve(request, response)


class NeverReturns(Node):
    def __init__(self):
        super().__init__('ik_service')
        group = ReentrantCallbackGroup()
        self.create_service(SolveIK, '/solve_ik', self.solve, callback_group=group)

    async def solve(self, request, response):
        await Future()


class Busy(IKService):
    def solve(self, request, response):
        STOP.wait(60.0)
        return super().solve(request, response)


@pytest.mark.parametrize(
    ('node_class', 'hint'),
    [
        (ReturnsNothing, 'end the callback with `return response`, in each of its branches'),
        (NeverReturns, '/ik_service runs, and the callback of this service has not returned'),
        (Busy, 'its callback has not returned ('),
    ],
)
@pytest.mark.usefixtures('impatient')
def test_a_missing_response_fails_with_its_cause(run, node_class, hint):
    run(node_class)
    with pytest.raises(CheckFailed, match=r'expected an answer, saw none( in 1 s)?: ') as failure:
        solve_ik.call(ik.request(*TARGETS[0]))
    assert hint in str(failure.value)


class Elsewhere(Node):
    def __init__(self, name='/solve_it', type_=SolveIK, *, node_name='ik_service'):
        super().__init__(node_name)
        self.create_service(type_, name, print)


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        ((), 'a server of /solve_ik, saw none.*: /ik_service uses /solve_it, so compare the sp'),
        (('~/solve_ik',), 'saw none.*/ik_service uses /ik_service/solve_ik'),
        (('/unlike',), r'/ik_service runs, so look at the service name in create_service\(…\)'),
        (('/solve_ik', Trigger), 'for arm_interfaces/srv/SolveIK, saw one for std_srvs/srv/Trig'),
    ],
)
@pytest.mark.usefixtures('impatient')
def test_a_missing_server_fails_with_its_likely_cause(run, arguments, message):
    run(Elsewhere, *arguments)
    with pytest.raises(CheckFailed, match=message):
        check_answers()


class OnATopic(Node):
    """Subscribes to the requests of a service: rclpy treats their type as a message type."""

    def __init__(self):
        super().__init__('ik_service')
        self.create_subscription(SolveIK.Request, '/solve_ik', print, 10)


@pytest.mark.usefixtures('impatient')
def test_a_topic_in_place_of_a_service_is_named(run):
    run(OnATopic)
    words = (
        r'/ik_service has a topic of this name.*: call create_service\(…\) in place of create_sub'
    )
    with pytest.raises(CheckFailed, match=words):
        check_answers()


@pytest.mark.usefixtures('impatient')
def test_a_second_server_fails_the_check(run):
    run(IKService, key='one')
    run(Elsewhere, '/solve_ik', node_name='another', key='two')
    with pytest.raises(CheckFailed, match=r'one server of /solve_ik, saw 2 \(/another, /ik_s'):
        check_answers()


@pytest.mark.usefixtures('impatient')
def test_a_missing_node_fails_with_advice_to_run_its_cell():
    with pytest.raises(CheckFailed, match='the node is not running, so run the cell that starts'):
        check_answers()


def test_the_solver_of_the_checks_refuses_to_run_in_the_student_room(monkeypatch):
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')
    assert ik.solve(ik.request(1.2, 0.8)).reachable
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'student')
    with pytest.raises(NotRunnable, match='a solution of your own'):
        ik.solve(ik.request(1.2, 0.8))
