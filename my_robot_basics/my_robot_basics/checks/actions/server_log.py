"""What rclpy's action server logs on `/rosout` about its callbacks."""

from collections import deque
from typing import Any

from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile

from my_robot_basics.feedback import hidden
from my_robot_basics.feedback.errors import shorten
from my_robot_basics.feedback.python_errors import hint_for_exception
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.watcher import Watcher

DEPTH = 100
MOST_LINES = 1000
MOST_CHARACTERS = 1000
"""How much of a log line is kept: more than any feedback shows."""
LOG_SEC = 0.5
"""How long to wait for a log line that may explain a fault, in s of free time."""
_RAISED = 'Error raised in execute callback: '
_NO_TEXT = (  # the log has no class of an exception; that of publish_feedback has no text either
    'the execute callback raised an exception without a text, such as a TypeError: give '
    'publish_feedback a MoveArm.Feedback(position=…, remaining=…)'
)
_NOT_SET = 'Goal state not set'
_NO_RESPONSE = 'did not return a GoalResponse'
_lines: dict[str, deque[tuple[int, str]]] = {}
"""The lines of each logger with their times. They are kept for later grade cells: `/rosout` may
have dropped a line that explains a fault seen there."""


class ServerLog:
    """The log lines of one node's action servers; they are used as hints, never for a verdict."""

    def __init__(self, watcher: Watcher, node_name: str) -> None:
        """Subscribe; latched, so lines logged shortly before arrive, too."""
        self._watcher = watcher
        self._logger = node_name.strip('/').replace('/', '.')
        self._lines = _lines.setdefault(self._logger, deque(maxlen=MOST_LINES))
        latched = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        watcher.node.create_subscription(Log, '/rosout', with_info(self._receive), latched)

    def raised(self, *, since_ns: int) -> str:
        """A clause about what the execute callback raised since a wall time, or ''."""
        said = self._find(_RAISED, since_ns)
        if not said:
            return ''
        said = said.removeprefix(_RAISED).strip()
        msg = hidden.student_text(shorten(said, 100))
        raised = f'the execute callback raised an exception ({msg})' if said else _NO_TEXT
        raised += hint_for_exception(said)
        # rclpy catches what this callback raises: its spin goes on, as it does for no other
        # in a package, the check starts the node, after the build
        return (
            f'{raised}; fix that first, and run again the cell that starts or builds the node: the'
            ' callback ended there'
        )

    def was_not_set(self, *, since_ns: int) -> bool:
        """Whether the execute callback ended without succeed(), abort() or canceled()."""
        return bool(self._find(_NOT_SET, since_ns))

    def had_no_response(self, *, since_ns: int) -> bool:
        """Whether the goal callback returned no GoalResponse."""
        return bool(self._find(_NO_RESPONSE, since_ns))

    def _find(self, part: str, since_ns: int) -> str:
        def found() -> list[str]:
            return [line for at, line in self._lines if at >= since_ns and part in line]

        self._watcher.spin_until_free(lambda: bool(found()), free_sec=LOG_SEC)
        return next(iter(found()), '')

    def _receive(self, message: Any, info: dict) -> None:
        is_ours = message.name == self._logger or message.name.startswith(f'{self._logger}.')
        if is_ours and any(part in message.msg for part in (_RAISED, _NOT_SET, _NO_RESPONSE)):
            self._lines.append((info['source_timestamp'], message.msg[:MOST_CHARACTERS]))
