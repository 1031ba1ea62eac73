"""Visits the targets of a parameter, one after the other, and reports how each of them ended."""

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Point
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK

ENDS = {
    GoalStatus.STATUS_SUCCEEDED: 'succeeded',
    GoalStatus.STATUS_CANCELED: 'canceled',
    GoalStatus.STATUS_ABORTED: 'aborted',
}
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class ArmPlayer(Node):
    """Asks /solve_ik for each target, and sends the answer to /move_arm"""

    def __init__(self):
        super().__init__('arm_player')
        self.declare_parameter('targets', [1.2, 0.8, 0.9, -0.9])
        self.solver = self.create_client(SolveIK, '/solve_ik')
        self.arm = ActionClient(self, MoveArm, '/move_arm')
        self.done = self.create_publisher(String, '/arm_player/done', LATCHED)

    def play(self):
        """Visit all targets, and report"""
        self.solver.wait_for_service()
        self.arm.wait_for_server()
        numbers = self.get_parameter('targets').value
        targets = zip(numbers[::2], numbers[1::2], strict=True)
        words = [self.visit(x, y) for x, y in targets]
        self.done.publish(String(data=' '.join(words)))

    def visit(self, x, y):
        """Return one word that says how a target ended"""
        answer = self.wait_for(self.solver.call_async(SolveIK.Request(target=Point(x=x, y=y))))
        if not answer.reachable:
            return 'unreachable'
        goal = MoveArm.Goal(position=answer.elbow_up, speed=0.5)
        goal_handle = self.wait_for(self.arm.send_goal_async(goal))
        if not goal_handle.accepted:
            return 'rejected'
        return ENDS[self.wait_for(goal_handle.get_result_async()).status]

    def wait_for(self, future):
        """Spin until a future is done: no callback does this, only main"""
        rclpy.spin_until_future_complete(self, future)
        if not future.done():
            raise ExternalShutdownException
        return future.result()


def main():
    try:
        rclpy.init()
        player = ArmPlayer()
        player.play()
        rclpy.spin(player)  # the report stays available
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
