"""An object that is not an action type gives an error message instead of a crash of rclpy."""

import pytest
from geometry_msgs.msg import Point
from my_robot_basics.language.speaking import in_language
from my_robot_basics.live import run, stop
from my_robot_basics.session.errors import WrongType
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK

pytestmark = pytest.mark.starts


class Mover(Node):
    """Makes both ends of an action, of a type each."""

    def __init__(self, served, asked=MoveArm):
        super().__init__('mover')
        self.server = ActionServer(self, served, '/move', lambda handle: MoveArm.Result())
        self.client = ActionClient(node=self, action_type=asked, action_name='/move')


@pytest.fixture(autouse=True)
def stopped():
    yield
    stop()


@pytest.mark.parametrize(
    ('given', 'seen'),
    [
        (SolveIK, 'SolveIK, the type of a service'),
        (SolveIK.Request, 'SolveIK.Request, a part of a type'),
        (MoveArm.Goal, 'MoveArm.Goal, a part of a type'),
        (MoveArm.Impl, "<class 'arm_interfaces.action._move_arm.MoveArm.Impl'>"),
        (Point, 'Point, the type of a message'),
        (Point(), 'geometry_msgs.msg.Point(x=0.0, y=0.0, z=0.0)'),
        ('/move', "'/move'"),
    ],
)
def test_what_is_no_type_of_an_action_is_named(given, seen):
    """Most of these would end this process."""
    for maker, types in ('ActionServer', (given,)), ('ActionClient', (MoveArm, given)):
        with pytest.raises(WrongType) as refused:
            run(Mover, *types)
        words = f'{maker} expects the type of an action, such as MoveArm, and got {seen}: '
        assert str(refused.value) == f'{words}write {maker}(self, MoveArm, …)'


def test_the_type_of_an_action_is_taken():
    assert run(Mover, MoveArm).client.server_is_ready() in (True, False)


def test_what_rclpy_says_of_a_type_that_is_left_out_stays():
    run(Mover, MoveArm)
    with pytest.raises(TypeError, match=r"missing .* 'action_type' and 'action_name'"):
        ActionClient(Mover(MoveArm))


def test_it_is_said_in_chinese():
    english = (
        'WrongType: ActionClient expects the type of an action, such as MoveArm, and got SolveIK, '
        'the type of a service: write ActionClient(self, MoveArm, …)'
    )
    assert in_language('zh_CN', english) == (
        'WrongType: ActionClient 需要动作的类型，例如 MoveArm，实际是 SolveIK（服务的类型）：'
        '请写 ActionClient(self, MoveArm, …)'
    )
