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
    """Makes both ends of an action; each end has its own type."""

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
def test_an_object_that_is_not_an_action_type_is_named_in_the_error(given, seen):
    """Most of these would end this process."""
    for maker, types in ('ActionServer', (given,)), ('ActionClient', (MoveArm, given)):
        with pytest.raises(WrongType) as refused:
            run(Mover, *types)
        words = f'{maker} expects the type of an action, such as MoveArm, and got {seen}: '
        assert str(refused.value) == f'{words}write {maker}(self, MoveArm, …)'


def test_an_action_type_is_accepted():
    assert run(Mover, MoveArm).client.server_is_ready() in (True, False)


def test_a_missing_action_type_raises_the_error_of_rclpy():
    mover = run(Mover, MoveArm)
    with pytest.raises(TypeError, match=r"missing .* 'action_type' and 'action_name'"):
        ActionClient(mover)


def test_the_error_about_a_wrong_action_type_is_translated_to_chinese():
    english = (
        'WrongType: ActionClient expects the type of an action, such as MoveArm, and got SolveIK, '
        'the type of a service: write ActionClient(self, MoveArm, …)'
    )
    assert in_language('zh_CN', english) == (
        'WrongType: ActionClient 需要动作的类型，例如 MoveArm，实际是 SolveIK（服务的类型）：'
        '请写 ActionClient(self, MoveArm, …)'
    )
