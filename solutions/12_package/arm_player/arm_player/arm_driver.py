"""Drives the arm: answers /solve_ik, and moves for the goals of /move_arm."""

import math

import rclpy
from my_robot_basics.two_link_kinematics import inverse_kinematics
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK


class ArmDriver(Node):
    """The server of lesson 8 and the action server of lesson 9, in one node"""

    def __init__(self):
        super().__init__('arm_driver')
        self.position = [0.0, 0.0]
        self.is_moving = False
        self.poses = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.create_service(SolveIK, '/solve_ik', self.solve)
        callbacks = {'goal_callback': self.judge, 'cancel_callback': self.cancel}
        ActionServer(self, MoveArm, '/move_arm', self.execute, **callbacks)

    def solve(self, request, response):
        try:
            solutions = inverse_kinematics(request.target.x, request.target.y)
        except ValueError as reason:
            response.message = str(reason)
            return response
        response.reachable = True
        response.elbow_up = [math.radians(angle) for angle in solutions['elbow_up']]
        response.elbow_down = [math.radians(angle) for angle in solutions['elbow_down']]
        return response

    def judge(self, goal):
        if self.is_moving or len(goal.position) != 2:
            return GoalResponse.REJECT
        joint1, joint2 = (math.degrees(angle) for angle in goal.position)
        if not (abs(joint1) <= 90.0 and abs(joint2) <= 120.0 and goal.speed > 0.0):
            return GoalResponse.REJECT
        self.is_moving = True
        return GoalResponse.ACCEPT

    def cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    async def execute(self, goal_handle):
        start, goal = self.position, list(goal_handle.request.position)
        way = [b - a for a, b in zip(start, goal, strict=True)]
        seconds = max(map(abs, way)) / goal_handle.request.speed
        began, part = self.get_clock().now(), 0.0
        while part < 1.0 and not goal_handle.is_cancel_requested:
            await self.sleep(0.05)
            passed = (self.get_clock().now() - began).nanoseconds / 1e9
            part = min(1.0, passed / seconds) if seconds else 1.0
            self.position = [a + part * b for a, b in zip(start, way, strict=True)]
            self.report(goal_handle, (1.0 - part) * max(map(abs, way)))
        self.is_moving = False
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.succeed()
        return MoveArm.Result(position=self.position)

    def report(self, goal_handle, left):
        goal_handle.publish_feedback(MoveArm.Feedback(position=self.position, remaining=left))
        pose = JointState(name=['joint1', 'joint2'], position=self.position)
        pose.header.stamp = self.get_clock().now().to_msg()
        pose.header.frame_id = 'base_link'
        self.poses.publish(pose)

    async def sleep(self, seconds):
        """Wait on the node's clock, while its other callbacks run"""
        over = Future()
        timer = self.create_timer(seconds, lambda: over.set_result(None))
        await over
        self.destroy_timer(timer)


def main():
    try:
        rclpy.init()
        rclpy.spin(ArmDriver())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
