"""Each planted fault of an action is reported first; a correct server has no fault."""

import pytest
from my_robot_basics.doctor.action_rules import judge
from my_robot_basics.doctor.diagnosing import diagnose
from my_robot_basics.doctor.evidence import Endpoint
from my_robot_basics.doctor.report import tell
from my_robot_basics.doctor.served_evidence import ActionEvidence, StandingGoal
from my_robot_basics.live import run, stop, wait_until
from my_robot_basics.session import classroom
from nodes.running import imported
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer
GOAL = MoveArm.Goal(position=[0.5, 0.2], speed=10.0)


@pytest.fixture(autouse=True)
def end():
    yield
    stop()


class Sender(Node):
    def __init__(self, name='/move_arm', goal=GOAL):
        super().__init__('sender')
        self.client = ActionClient(self, MoveArm, name)
        self.goal, self.accepted, self.result = goal, None, None

    def send(self):
        assert self.client.wait_for_server(timeout_sec=30.0)
        self.client.send_goal_async(self.goal).add_done_callback(self.take)
        wait_until(lambda: self.accepted is not None)

    def take(self, future):
        self.accepted = future.result()
        self.result = self.accepted.get_result_async()


def told(name='/move_arm'):
    """Return the doctor's report on an action, and the titles of its findings."""
    [diagnosis] = diagnose(name, domain_id=classroom.enter())
    return ' '.join(tell(diagnosis).split()), [each.title for each in diagnosis.findings]


@pytest.mark.slow
def test_no_fault_is_found_in_a_correct_action_server():
    run(MoveArmServer)
    sender = run(Sender)
    sender.send()
    wait_until(sender.result.done)
    assert told() == ('All is well on /move_arm: /move_arm_server serves, /sender asks.', [])


@pytest.mark.slow
def test_a_goal_in_progress_is_not_reported_as_a_fault():
    run(MoveArmServer)
    run(Sender, goal=MoveArm.Goal(position=[1.5, 0.0], speed=0.01)).send()
    said, titles = told()
    assert titles == []
    assert '1 goal goes on' in said


@pytest.mark.slow
def test_a_missing_action_server_is_reported_with_the_line_that_makes_one():
    run(Sender)
    said, titles = told()
    assert titles == ['no action server']
    assert "self.server = ActionServer(self, MoveArm, '/move_arm', self.execute)" in said
    assert 'saw none; clients: /sender; other nodes: none' in said


@pytest.mark.slow
def test_a_misspelt_action_name_is_reported():
    run(MoveArmServer)
    run(Sender, name='/movearm')
    said, titles = told('/movearm')
    assert titles[0] == 'a similar name: the spelling differs'
    assert "ActionServer(self, MoveArm, '/movearm', self.execute)" in said


class Forgets(MoveArmServer):
    def finish(self, handle):
        self.is_moving = False
        return MoveArm.Result(position=self.position)


class Raises(MoveArmServer):
    def step(self, handle):
        raise KeyError('joint3')


class ReportsNumbers(MoveArmServer):
    def report(self, handle):
        handle.publish_feedback(self.position)


class NeverExecutes(MoveArmServer):
    def make_server(self, **callbacks):
        return super().make_server(handle_accepted_callback=lambda handle: None, **callbacks)


class NeverEnds(MoveArmServer):
    async def execute(self, handle):
        await Future()


FAULTS = [
    (Forgets, 'nobody has set how the goal ended', 'goal_handle.succeed()'),
    (Raises, 'the execute callback raised', 'a moment ago'),
    (ReportsNumbers, 'the execute callback raised', 'MoveArm.Feedback(position=…, remaining=…)'),
    (NeverExecutes, 'a goal does not go on', 'a goal that was accepted for at least'),
    (NeverEnds, 'a goal does not go on', 'a goal that was executing for at least'),
]


@pytest.mark.parametrize(('node_class', 'title', 'words'), FAULTS)
def test_a_goal_that_ends_wrongly_or_not_at_all_is_reported(node_class, title, words):
    run(node_class)
    sender = run(Sender)
    sender.send()
    if node_class in (Forgets, Raises, ReportsNumbers):
        wait_until(sender.result.done)
    said, titles = told()
    assert titles == [title]
    assert words in said


# --- rules on made-up evidence -------------------------------------------------------------------

SERVER = Endpoint(
    kind='server', node_name='/arm', name='/a', type_name='arm_interfaces/action/MoveArm'
)
CLIENT = Endpoint(
    kind='client', node_name='/station', name='/a', type_name='test_msgs/action/Fibonacci'
)


def found(**seen):
    evidence = ActionEvidence(name='/a', nodes={}, **{'endpoints': (SERVER,)} | seen)
    return [(each.title, each.code) for each in judge(evidence).findings]


def test_different_types_are_reported_with_a_fix_for_the_client():
    line = "self.client = ActionClient(self, MoveArm, '/a')"
    assert found(endpoints=(SERVER, CLIENT)) == [('types differ', line)]


@pytest.mark.parametrize(
    ('state', 'line'),
    [
        ('accepted', 'goal_handle.execute()'),
        ('executing', 'goal_handle.publish_feedback(feedback)'),
        ('canceling', 'goal_handle.canceled()'),
    ],
)
def test_each_state_of_a_stalled_goal_has_its_own_fix(state, line):
    goals = (StandingGoal(state=state, seconds=3.2),)
    assert found(goals=goals) == [('a goal does not go on', line)]


def test_a_callback_that_raised_is_not_also_reported_for_an_unset_status():
    raised = (('/arm', "KeyError('joint3')"),)
    assert found(raised=raised, unset=frozenset({'/arm'})) == [('the execute callback raised', '')]
