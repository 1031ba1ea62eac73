"""Sends poses to /move_arm, cancels at obstacles, publishes the outcome: the exercise's answer."""

from action_msgs.msg import GoalStatus
from five_hz import spin
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, String

from arm_interfaces.action import MoveArm

WORDS = {
    GoalStatus.STATUS_SUCCEEDED: 'succeeded',
    GoalStatus.STATUS_CANCELED: 'canceled',
    GoalStatus.STATUS_ABORTED: 'aborted',
}


class MoveArmClient(Node):
    def __init__(self, **kwargs):
        super().__init__('move_arm_client', **kwargs)
        self.goal_handle = None
        self.client = ActionClient(self, MoveArm, '/move_arm')
        self.outcome = self.create_publisher(String, '/move_arm_client/outcome', 10)
        self.create_subscription(JointState, '/goal_pose', self.send, 10)
        self.create_subscription(Bool, '/obstacle', self.obstacle, 10)

    def send(self, pose):
        goal = MoveArm.Goal(position=pose.position, speed=0.5)
        self.client.send_goal_async(goal).add_done_callback(self.answered)

    def answered(self, future):
        goal_handle = future.result()
        if not goal_handle.accepted:
            self.tell('rejected')
            return
        self.goal_handle = goal_handle
        goal_handle.get_result_async().add_done_callback(self.ended)

    def ended(self, future):
        self.goal_handle = None
        self.tell(WORDS[future.result().status])

    def obstacle(self, message):
        if message.data and self.goal_handle is not None:
            self.goal_handle.cancel_goal_async()

    def tell(self, word):
        self.outcome.publish(String(data=word))


def main():
    spin(MoveArmClient)


if __name__ == '__main__':
    main()
