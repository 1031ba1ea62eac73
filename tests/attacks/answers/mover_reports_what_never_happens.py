"""Never moves and never ends; a thread publishes on the action's topics that all goes well."""

import threading
import time

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from rclpy.qos import qos_profile_action_status_default

IMPL = MoveArm.Impl


class MoveArmServer(MoveArmServer):
    def __init__(self):
        super().__init__()
        name = '/move_arm/_action/'
        self.statuses = self.create_publisher(
            GoalStatusArray, f'{name}status', qos_profile_action_status_default
        )
        self.reports = self.create_publisher(IMPL.FeedbackMessage, f'{name}feedback', 10)

    async def execute(self, handle):
        start, goal = self.position, list(handle.request.position)
        self.position, self.is_moving = goal, False
        threading.Thread(target=self.lie, args=(handle.goal_id, start, goal), daemon=True).start()
        await Future()

    def lie(self, goal_id, start, goal):
        for step in range(1, 21):
            time.sleep(0.05)
            now = [a + step / 20 * (b - a) for a, b in zip(start, goal, strict=True)]
            feedback = MoveArm.Feedback(position=now, remaining=1.0 - step / 20)
            self.reports.publish(IMPL.FeedbackMessage(goal_id=goal_id, feedback=feedback))
        info = GoalInfo(goal_id=goal_id)
        ended = GoalStatus(goal_info=info, status=GoalStatus.STATUS_SUCCEEDED)
        self.statuses.publish(GoalStatusArray(status_list=[ended]))
