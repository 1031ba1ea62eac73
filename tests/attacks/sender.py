"""An honest client of the action; the code of an attack `sender_…` is appended."""

from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, String

from arm_interfaces.action import MoveArm

WORDS = {4: 'succeeded', 5: 'canceled', 6: 'aborted'}


class MoveArmClient(Node):
    def __init__(self):
        super().__init__('move_arm_client')
        self.goal_handle = None
        self.client = ActionClient(self, MoveArm, '/move_arm')
        self.outcomes = self.create_publisher(String, '/move_arm_client/outcome', 10)
        self.create_subscription(JointState, '/goal_pose', self.send, 10)
        self.create_subscription(Bool, '/obstacle', self.obstacle, 10)

    def send(self, pose):
        goal = MoveArm.Goal(position=pose.position, speed=0.5)
        self.client.send_goal_async(goal).add_done_callback(self.respond)

    def respond(self, future):
        if not future.result().accepted:
            self.say('rejected')
            return
        self.goal_handle = future.result()
        self.goal_handle.get_result_async().add_done_callback(self.end)

    def end(self, future):
        self.say(WORDS[future.result().status])

    def obstacle(self, message):
        if message.data and self.goal_handle is not None:
            self.goal_handle.cancel_goal_async()

    def say(self, word):
        self.outcomes.publish(String(data=word))
