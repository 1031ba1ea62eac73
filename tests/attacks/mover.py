"""An honest server of the action; the code of an attack `mover_…` is appended."""

import math

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future

from arm_interfaces.action import MoveArm


class MoveArmServer(Node):
    def __init__(self):
        super().__init__('move_arm_server')
        self.position, self.is_moving = [0.0, 0.0], False
        self.server = ActionServer(
            self,
            MoveArm,
            '/move_arm',
            self.execute,
            goal_callback=self.judge,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def judge(self, goal):
        limits = math.radians(90), math.radians(120)
        is_right = len(goal.position) == 2 and goal.speed > 0.0 and not self.is_moving
        is_right = is_right and all(
            abs(q) <= limit for q, limit in zip(goal.position, limits, strict=True)
        )
        self.is_moving = self.is_moving or is_right
        return GoalResponse.ACCEPT if is_right else GoalResponse.REJECT

    async def execute(self, handle):
        start, goal = self.position, list(handle.request.position)
        far = max(abs(b - a) for a, b in zip(start, goal, strict=True))
        seconds, part = self.seconds_for(far, handle.request), 0.0
        began = self.now_sec()
        while part < 1.0 and not handle.is_cancel_requested:
            await self.wait(0.05)
            part = min(1.0, (self.now_sec() - began) / seconds) if seconds else 1.0
            self.position = [a + part * (b - a) for a, b in zip(start, goal, strict=True)]
            self.tell(handle, (1.0 - part) * far)
        self.is_moving = False
        handle.canceled() if handle.is_cancel_requested else handle.succeed()
        return self.result()

    def seconds_for(self, far, goal):
        return far / goal.speed

    def now_sec(self):
        return self.get_clock().now().nanoseconds / 1e9

    async def wait(self, seconds):
        over = Future()
        timer = self.create_timer(seconds, lambda: over.set_result(None))
        await over
        self.destroy_timer(timer)

    def tell(self, handle, left):
        handle.publish_feedback(MoveArm.Feedback(position=self.position, remaining=left))

    def result(self):
        return MoveArm.Result(position=self.position)
