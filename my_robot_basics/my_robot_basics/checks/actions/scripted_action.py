"""An action server that accepts, rejects and ends goals as the check tells it to."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future
from rclpy.timer import Timer

from my_robot_basics.checks.services.sending import wait_for_readers

Ending = Literal['succeeded', 'aborted', 'canceled']
REPORT_SEC = 0.1
"""The period of the feedback on each executing goal."""
SERVICES = 'send_goal', 'get_result', 'cancel_goal'
"""The services of an action server."""


@dataclass
class ReceivedGoal:
    """A goal that the server has received."""

    request: Any
    """The goal's message."""
    is_accepted: bool
    end: Future = field(default_factory=Future)
    """Its result is the Ending that `finish` was given; the goal executes until then."""
    cancels: list[int] = field(default_factory=list)
    """When each request to cancel the goal came: wall time in ns."""
    received_ns: int = field(default_factory=time.time_ns)
    """When the goal came: wall time in ns."""

    def cancelled_sec(self) -> float:
        """The time from the goal to the first request to cancel it, in s; 0 if there was none."""
        return (self.cancels[0] - self.received_ns) / 1e9 if self.cancels else 0.0

    def finish(self, ending: Ending) -> None:
        """Let the goal end with that status."""
        self.end.set_result(ending)


class ScriptedActionServer:
    """An action server that exists from `start` to `stop`; the caller spins the node."""

    def __init__(self, node: Node, *, name: str, type_: type) -> None:
        self.name, self.type = name, type_
        self.goals: list[ReceivedGoal] = []
        """All goals that the server has received, in order."""
        self.is_expected: Callable[[Any], bool] = lambda _: False
        """Whether a goal is the one that the check waits for; any other succeeds at once."""
        self.accepts = True
        """Whether the server accepts the expected goal."""
        self.cancels = True
        """Whether the server accepts requests to cancel."""
        self.reports: Callable[[Any], Any] | None = None
        """Makes the feedback on an executing goal from the goal's message; None: no feedback."""
        self.starts = 0
        """How often `start` was called."""
        self._node = node
        self._timer: Timer | None = None
        self._server: ActionServer | None = None
        self._services = [f'{name}/_action/{end}' for end in SERVICES]
        self._executed: list[ReceivedGoal] = []

    def start(self) -> None:
        """Create the action server."""
        self._server = ActionServer(
            self._node,
            self.type,
            self.name,
            self._execute,
            goal_callback=self._judge,
            cancel_callback=self._cancel,
            handle_accepted_callback=self._take,
        )
        self._handles: dict[bytes, ReceivedGoal] = {}
        self._moving: list[ServerGoalHandle] = []
        self._timer = self._node.create_timer(REPORT_SEC, self._report)
        self.starts += 1

    def count_over(self) -> int:
        """How many goals have ended or were rejected: their outcomes may come late."""
        return sum(goal.end.done() or not goal.is_accepted for goal in self.goals)

    def is_there(self) -> bool:
        """Whether the action server exists."""
        return self._server is not None

    def stop(self) -> None:
        """Destroy the action server."""
        if self._server is not None and self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._server.destroy()
            self._server = None

    def _judge(self, request: Any) -> GoalResponse:
        is_expected = self.is_expected(request)
        accepts = self._accepts(request)
        received = ReceivedGoal(request, accepts)
        self.goals.append(received)
        if not is_expected:
            received.finish('succeeded')
        if accepts:
            self._executed.append(received)
        wait_for_readers(self._node, self._services, asked=f'{self.name}/_action/send_goal')
        return GoalResponse.ACCEPT if accepts else GoalResponse.REJECT

    def _accepts(self, request: Any) -> bool:
        return self.accepts or not self.is_expected(request)

    def _take(self, handle: ServerGoalHandle) -> None:
        self._handles[bytes(handle.goal_id.uuid)] = self._executed.pop(0)
        handle.execute()

    async def _execute(self, handle: ServerGoalHandle) -> Any:
        received = self._handles[bytes(handle.goal_id.uuid)]
        self._moving.append(handle)
        ending = await received.end
        self._moving.remove(handle)
        wait_for_readers(self._node, self._services)
        if ending == 'succeeded':
            handle.succeed()
        elif ending == 'aborted':
            handle.abort()
        else:
            handle.canceled()
        return self.type.Result()  # type: ignore[attr-defined]

    def _report(self) -> None:
        if self.reports is not None:
            for handle in self._moving:
                handle.publish_feedback(self.reports(handle.request))

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        self._handles[bytes(handle.goal_id.uuid)].cancels.append(time.time_ns())
        wait_for_readers(self._node, self._services, asked=f'{self.name}/_action/cancel_goal')
        return CancelResponse.ACCEPT if self.cancels else CancelResponse.REJECT
