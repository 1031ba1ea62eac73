"""No server of an action, or two: the check names the node and the likely cause."""

import pytest
from my_robot_basics.checks import CheckFailed, action, moves
from my_robot_basics.checks.services import awaited_servers
from nodes.running import imported
from rclpy.action import ActionServer
from rclpy.node import Node
from std_srvs.srv import Trigger

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer


@pytest.fixture
def impatient(monkeypatch):
    """Shorten the waits for messages that never come."""
    monkeypatch.setattr(awaited_servers, 'SERVER_SEC', 1.0)


class Elsewhere(Node):
    def __init__(self, name='/move_it', type_=MoveArm, *, node_name='move_arm_server'):
        super().__init__(node_name)
        if type_ is MoveArm:
            ActionServer(self, type_, name, print)
        else:
            self.create_service(type_, name, print)


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        (
            (),
            'a server of the action /move_arm, saw none.*: /move_arm_server uses /move_it, so co',
        ),
        (('~/move_arm',), 'saw none.*/move_arm_server uses /move_arm_server/move_arm'),
        (('/unlike',), r'/move_arm_server runs, so look at the action name in ActionServer\(…\)'),
        (('/move_arm', Trigger), r'runs, so look at the action name in ActionServer\(…\)'),
    ],
)
@pytest.mark.usefixtures('impatient')
def test_a_missing_action_server_fails_with_its_likely_cause(run, arguments, message):
    run(Elsewhere, *arguments)
    with pytest.raises(CheckFailed, match=message):
        action('/move_arm', MoveArm).send_goal(moves.goal((0.5, 0.2)))


@pytest.mark.usefixtures('impatient')
def test_a_second_action_server_fails_the_check(run):
    run(MoveArmServer, key='one')
    run(Elsewhere, '/move_arm', node_name='another', key='two')
    with pytest.raises(CheckFailed, match=r'one server of the action /move_arm, saw 2 \(/anoth'):
        action('/move_arm', MoveArm).send_goal(moves.goal((0.5, 0.2)))


@pytest.mark.usefixtures('impatient')
def test_a_missing_node_fails_with_advice_to_run_its_cell():
    with pytest.raises(CheckFailed, match='the node is not running, so run the cell that starts'):
        action('/move_arm', MoveArm).send_goal(moves.goal((0.5, 0.2)))
