"""Moves the arm in a straight line, reports, rejects and cancels: the exercise's answer."""

import math

from five_hz import spin
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future

from arm_interfaces.action import MoveArm

LIMITS_RAD = math.radians(90.0), math.radians(120.0)
STEP_SEC = 0.05


class MoveArmServer(Node):
    def __init__(self, **kwargs):
        super().__init__('move_arm_server', **kwargs)
        self.position = [0.0, 0.0]
        self.is_moving = False
        self.server = self.make_server(goal_callback=self.judge, cancel_callback=self.cancel)

    def make_server(self, **callbacks):
        return ActionServer(self, MoveArm, '/move_arm', self.execute, **callbacks)

    def judge(self, goal):
        if not self.is_possible(goal) or self.is_moving:
            return GoalResponse.REJECT
        self.is_moving = True
        return GoalResponse.ACCEPT

    def is_possible(self, goal):
        return (
            len(goal.position) == len(LIMITS_RAD)
            and all(abs(q) <= limit for q, limit in zip(goal.position, LIMITS_RAD, strict=True))
            and goal.speed > 0.0
        )

    def cancel(self, _):
        return CancelResponse.ACCEPT

    async def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0 and not handle.is_cancel_requested:
            await self.sleep(STEP_SEC)
            self.step(handle)
        return self.finish(handle)

    async def sleep(self, seconds):
        over = Future()
        timer = self.create_timer(seconds, lambda: over.set_result(None))
        await over
        self.destroy_timer(timer)

    def begin(self, handle):
        self.target, self.start = list(handle.request.position), list(self.position)
        self.way = [b - a for a, b in zip(self.start, self.target, strict=True)]
        self.seconds = max(map(abs, self.way)) / handle.request.speed
        self.began, self.part = self.get_clock().now(), 0.0

    def step(self, handle):
        passed_sec = (self.get_clock().now() - self.began).nanoseconds / 1e9
        self.part = min(1.0, passed_sec / self.seconds) if self.seconds else 1.0
        self.position = self.on_the_way()
        self.report(handle)

    def on_the_way(self):
        return [a + self.part * d for a, d in zip(self.start, self.way, strict=True)]

    def report(self, handle):
        remaining = (1.0 - self.part) * max(map(abs, self.way))
        feedback = MoveArm.Feedback(position=self.position, remaining=remaining)
        handle.publish_feedback(feedback)

    def finish(self, handle):
        self.is_moving = False
        if handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.succeed()
        return MoveArm.Result(position=self.position)


def main():
    spin(MoveArmServer)


if __name__ == '__main__':
    main()
