"""The check's own action client, which keeps all that the action server publishes."""

import time
import uuid
from collections.abc import Callable
from typing import Any

from action_msgs.msg import GoalInfo, GoalStatus
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from unique_identifier_msgs.msg import UUID

from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.graph.watcher import Watcher

DEPTH = 5000
"""Depth of the feedback's queue: more messages than any move publishes."""
STATUS_NAMES = {
    GoalStatus.STATUS_UNKNOWN: 'unknown',
    GoalStatus.STATUS_ACCEPTED: 'accepted',
    GoalStatus.STATUS_EXECUTING: 'executing',
    GoalStatus.STATUS_CANCELING: 'canceling',
    GoalStatus.STATUS_SUCCEEDED: 'succeeded',
    GoalStatus.STATUS_CANCELED: 'canceled',
    GoalStatus.STATUS_ABORTED: 'aborted',
}
TERMINAL = 'succeeded', 'canceled', 'aborted'
"""Names of the statuses with which a goal has ended."""


class SentGoal:
    """A goal that a check has sent, with the answer, the statuses, the feedback and the result."""

    def __init__(
        self, goal: Any, goal_id: UUID, ends: 'ActionEnds', ask_for_result: Callable[[], Future]
    ) -> None:
        self.goal = goal
        """The goal's message."""
        self.id = goal_id
        self.sent_ns = time.time_ns()
        """When it was sent, on the wall clock."""
        self._ends, self._ask_for_result = ends, ask_for_result
        self._received_before = len(ends.feedback.received)
        self._result: Future | None = None
        self.answer: Future = Future()
        """The server's answer to the goal; set by the code that sends the goal."""

    @property
    def is_accepted(self) -> bool:
        """Whether the server has accepted the goal; False if it has not answered yet."""
        return bool(self.answer.done() and self.answer.result().accepted)

    @property
    def status(self) -> str:
        """The last status that was published, or that of the result; '' if there is none yet."""
        if self.has_result():
            return STATUS_NAMES.get(self._response().status, 'unknown')
        statuses = self.statuses()
        return statuses[-1][1] if statuses else ''

    @property
    def result(self) -> Any:
        """The result's message, or None if it was not received yet."""
        return self._response().result if self.has_result() else None

    def ask_for_result(self) -> None:
        """Ask the server to send the result once there is one. Only an accepted goal has one."""
        self._result = self._ask_for_result()

    def has_result(self) -> bool:
        """Whether the result was received."""
        return self._result is not None and self._result.done()

    def is_answered(self) -> bool:
        """Whether the result was received, or the client that sent the goal has left."""
        return self.has_result() or self._ends.is_gone

    def is_over(self) -> bool:
        """Whether the server says that the goal has ended, by its status or the result."""
        return self.status in TERMINAL or self.has_result()

    def statuses(self) -> list[tuple[int, str]]:
        """Each change of the status as (wall time in ns when it was published, name)."""
        return self._ends.statuses_of(self.id)

    def feedback(self) -> list[tuple[int, Any]]:
        """The feedback on this goal so far, as (wall time in ns when it was sent, message)."""
        return [
            (sent_ns, message.feedback)
            for message, sent_ns in self._ends.feedback.received
            if bytes(message.goal_id.uuid) == bytes(self.id.uuid)
        ]

    def feedback_count(self) -> int:
        """How many feedback messages came since the goal was sent, whatever their goal; fast."""
        return len(self._ends.feedback.received) - self._received_before

    def over_ns(self) -> int:
        """When the server published a terminal status: wall time in ns; 0 if it has not yet."""
        return next((at for at, name in self.statuses() if name in TERMINAL), 0)

    def _response(self) -> Any:
        assert self._result is not None
        return self._result.result()


class ActionEnds:
    """The parts of an action client: three service clients and two subscriptions."""

    def __init__(self, watcher: Watcher, name: str, type_: type) -> None:
        """Make them; before you send a goal, wait for `is_connected`."""
        self.is_gone = False
        self._node = watcher.node
        impl = type_.Impl  # type: ignore[attr-defined]
        self._impl = impl
        kinds = {
            'send_goal': impl.SendGoalService,
            'get_result': impl.GetResultService,
            'cancel_goal': impl.CancelGoalService,
        }
        self._clients = {
            end: self._node.create_client(kind, f'{name}/_action/{end}')
            for end, kind in kinds.items()
        }
        self.feedback = Recorder(
            watcher,
            topic_name=f'{name}/_action/feedback',
            type_=impl.FeedbackMessage,
            qos_profile=QoSProfile(depth=DEPTH),
        )
        self.statuses = Recorder(
            watcher,
            topic_name=f'{name}/_action/status',
            type_=impl.GoalStatusMessage,
            # of rclpy's depth, 1, the next goal's status would replace the end of the one before
            qos_profile=QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        )
        self._read = 0
        self._statuses: dict[bytes, list[tuple[int, str]]] = {}

    def statuses_of(self, goal_id: UUID) -> list[tuple[int, str]]:
        """Each change of a goal's status as (wall time in ns when it was published, name)."""
        new, self._read = self.statuses.received[self._read :], len(self.statuses.received)
        for message, sent_ns in new:
            for each in message.status_list:
                name = STATUS_NAMES.get(each.status, 'unknown')
                found = self._statuses.setdefault(bytes(each.goal_info.goal_id.uuid), [])
                if not found or found[-1][1] != name:
                    found.append((sent_ns, name))
        return self._statuses.get(bytes(goal_id.uuid), [])

    def is_connected(self) -> bool:
        """Whether all three clients and both subscriptions have discovered a server."""
        ready = all(client.service_is_ready() for client in self._clients.values())
        return ready and self.feedback.is_connected() and self.statuses.is_connected()

    def send(self, goal: Any) -> SentGoal:
        """Send a goal and return at once, before the answer comes."""
        goal_id = UUID(uuid=list(uuid.uuid4().bytes))
        sent = SentGoal(goal, goal_id, self, lambda: self._ask_for_result(goal_id))
        request = self._impl.SendGoalService.Request(goal_id=goal_id, goal=goal)
        sent.answer = self._clients['send_goal'].call_async(request)
        return sent

    def cancel(self, sent: SentGoal) -> Future:
        """Send a request to cancel a goal; the future's result is a CancelGoal.Response."""
        return self._cancel(GoalInfo(goal_id=sent.id))

    def cancel_all(self) -> Future:
        """Send a request to cancel every goal of the server."""
        return self._cancel(GoalInfo())

    def has_active(self) -> bool:
        """Whether any client's goal has not ended, by the last status message."""
        received = self.statuses.messages()
        return bool(received) and any(
            STATUS_NAMES.get(each.status) not in TERMINAL for each in received[-1].status_list
        )

    def leave(self) -> None:
        """Destroy the clients and subscriptions, as if this client had crashed."""
        self.is_gone = True
        for client in self._clients.values():
            self._node.destroy_client(client)
        self.feedback.close()
        self.statuses.close()

    def _cancel(self, goal_info: GoalInfo) -> Future:
        request = self._impl.CancelGoalService.Request(goal_info=goal_info)
        return self._clients['cancel_goal'].call_async(request)

    def _ask_for_result(self, goal_id: UUID) -> Future:
        request = self._impl.GetResultService.Request(goal_id=goal_id)
        return self._clients['get_result'].call_async(request)


def cancels(response: Any, sent: SentGoal) -> bool:
    """Whether the answer to `cancel` says that this goal is being cancelled."""
    ids = [bytes(info.goal_id.uuid) for info in response.goals_canceling]
    return bytes(sent.id.uuid) in ids
