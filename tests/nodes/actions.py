"""An action in a namespace that counts down in steps, and one that is hidden.

A goal without speed is rejected, and one of a negative speed is aborted. One of the speed 1.0 goes
on until it is cancelled, and one of the speed 2.0 for two seconds, cancelled or not.
"""

import contextlib
import time

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty

from arm_interfaces.action import MoveArm

ON_REQUEST, STUBBORN = 1.0, 2.0


class Mover(Node):
    def __init__(self):
        super().__init__('mover', namespace='/my_ns')
        group = ReentrantCallbackGroup()
        for name in 'move_arm', '_move_arm':
            ActionServer(
                *(self, MoveArm, name, self.execute),
                callback_group=group,
                goal_callback=self.consider,
                cancel_callback=self.consider_cancel,
            )
        self.ready = self.create_publisher(Empty, '_mover_is_up', 10)

    def consider(self, goal):
        return GoalResponse.ACCEPT if goal.speed else GoalResponse.REJECT

    def consider_cancel(self, handle):
        stubborn = handle.request.speed == STUBBORN
        return CancelResponse.REJECT if stubborn else CancelResponse.ACCEPT

    def execute(self, handle):
        goal, end = handle.request, time.monotonic() + 2.0
        for left in range(2, -1, -1):
            feedback = MoveArm.Feedback(position=goal.position, remaining=float(left))
            handle.publish_feedback(feedback)
        while goal.speed == ON_REQUEST and not handle.is_cancel_requested:
            time.sleep(0.01)
        while goal.speed == STUBBORN and time.monotonic() < end:
            time.sleep(0.01)
        if handle.is_cancel_requested:
            handle.canceled()
        elif goal.speed > 0.0:
            handle.succeed()
        return MoveArm.Result(position=goal.position)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    executor.add_node(Mover())
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    main()
