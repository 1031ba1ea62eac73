"""The check's own `/solve_ik` and `/move_arm`: a list of targets says what they answer."""

from collections.abc import Sequence
from typing import Any

from action_msgs.srv import CancelGoal
from rclpy.client import Client

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK
from my_robot_basics.checks.actions.action_ends import TERMINAL
from my_robot_basics.checks.actions.scripted_action import ReceivedGoal, ScriptedActionServer
from my_robot_basics.checks.services.holding_server import HoldingServer
from my_robot_basics.checks.values.solutions import is_for, request, solve
from my_robot_basics.feedback.errors import expect
from my_robot_basics.graph.watcher import Watcher

SOLVE_IK, MOVE_ARM = '/solve_ik', '/move_arm'
Target = tuple[str, float, float]
"""How the target ends (one of WORDS), and its x and y in metres."""
WORDS = *TERMINAL, 'rejected', 'unreachable'
L1_M = 1.3
"""The first link of the check's arm, unlike the course's: see `player`."""
NEAR_RAD = 1e-6
MOST_GOALS = 500
CANCEL_SEC = 4.0
"""How long the check's request to cancel may take to arrive, in s of free time."""


class PlayerServers(ScriptedActionServer):
    """Both servers; they do not exist until `start`."""

    def __init__(self, watcher: Watcher, targets: Sequence[Target]) -> None:
        super().__init__(watcher.node, name=MOVE_ARM, type_=MoveArm)
        self.targets = targets
        self.is_expected = lambda _: True
        self.solver = HoldingServer(
            watcher.node, name=SOLVE_IK, type_=SolveIK, answer=self._answer
        )
        self._watcher = watcher
        self._canceller: Client | None = None

    def start(self) -> None:
        """Start those of the two servers that do not run yet."""
        if not self.solver.is_there():
            self.solver.start()
        if not self.is_there():
            super().start()

    def start_arm(self) -> None:
        """Start only `/move_arm`."""
        super().start()

    def stop(self) -> None:
        """Abort the goals that have not ended, and destroy both servers."""
        for goal in self.goals:
            if not goal.end.done():
                goal.finish('aborted')
        self._watcher.spin_for(0.1)
        self.solver.stop()
        super().stop()

    def pose(self, number: int) -> list[float]:
        """The position that the goal for a target must have, in radians."""
        _, x, y = self.targets[number]
        return list(solve(request(x, y), l1=L1_M).elbow_up)

    def was_asked(self, number: int) -> bool:
        """Whether a request came for a target; a repeated target needs as many requests."""
        _, x, y = self.targets[number]
        count = sum(is_for(asked, x, y) for asked in self.solver.requests)
        return count > self.times_before(number)

    def times_before(self, number: int) -> int:
        """How often the same point is in the list before this target."""
        return [point for _, *point in self.targets[:number]].count([*self.targets[number][1:]])

    def was_skipped(self, number: int) -> bool:
        """Whether a request came for a later target, and none for this one."""
        later = range(number + 1, len(self.targets))
        return not self.was_asked(number) and any(map(self.was_asked, later))

    def stray_requests(self) -> list[Any]:
        """The requests for points that are not targets."""
        points = [(x, y) for _, x, y in self.targets]
        return [r for r in self.solver.requests if not any(is_for(r, *each) for each in points)]

    def number_of(self, goal: Any) -> int | None:
        """The index of the first target that a goal is for, or None."""
        numbers = (n for n in range(len(self.targets)) if is_near(goal.position, self.pose(n)))
        return next(numbers, None)

    def cancel(self, goal: ReceivedGoal) -> None:
        """Cancel an executing goal, as any client may, and end it as canceled."""
        if self._canceller is None:
            name = f'{MOVE_ARM}/_action/cancel_goal'
            self._canceller = self._watcher.node.create_client(CancelGoal, name)
            self._watcher.spin_until(self._canceller.service_is_ready, timeout_sec=CANCEL_SEC)
        self._canceller.call_async(CancelGoal.Request())  # without a goal id: all goals
        self._watcher.spin_until_free(lambda: bool(goal.cancels), free_sec=CANCEL_SEC)
        goal.finish('canceled')

    def _accepts(self, request: Any) -> bool:
        number = self.number_of(request)
        return number is None or self.targets[number][0] != 'rejected'

    def _answer(self, asked: Any) -> Any:
        for word, x, y in self.targets:
            if is_for(asked, x, y) and word == 'unreachable':
                return SolveIK.Response(message='this arm does not get there')
        return solve(asked, l1=L1_M)

    def _judge(self, request: Any) -> Any:
        expect(
            len(self.goals) < MOST_GOALS,
            expected=f'a goal for {MOVE_ARM} for each target',
            seen=f'{MOST_GOALS} of them',
            hint='send one goal for each target, not in an endless loop',
            cause=f'{MOVE_ARM} is sent goals again and again',
        )
        return super()._judge(request)


def is_near(seen: Sequence[float], wanted: Sequence[float]) -> bool:
    """Whether both are the same position in radians."""
    return len(seen) == len(wanted) and all(
        abs(a - b) < NEAR_RAD for a, b in zip(seen, wanted, strict=True)
    )
