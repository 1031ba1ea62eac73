"""An action as a check sees it: send its server a goal, and say why no answer comes."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any

from my_robot_basics.checks.open_action import OpenAction
from my_robot_basics.feedback.errors import CheckFailed
from my_robot_basics.graph.watcher import Watcher

RESULT_SEC = 10.0
"""How long `send_goal` waits for the end of a goal, of time that was free."""


def action(name: str, type_: type) -> 'Action':
    """The action of that (absolute) name and type, to be sent goals.

    `outcome = action('/move_arm', MoveArm).send_goal(MoveArm.Goal(position=[0.5, 0.2]))`
    """
    return Action(name, type_)


@dataclass(frozen=True)
class Outcome:
    """How a goal ended."""

    status: str
    """'rejected', 'succeeded', 'canceled' or 'aborted'."""
    result: Any
    """The result's message; None where it was rejected."""
    feedback: tuple[Any, ...]
    """The feedback's messages."""


class FollowedClock(Enum):
    """Which clock a server follows."""

    DRIVEN = auto()
    """That of its node, which a check drives."""
    WALL = auto()
    BOTH = auto()
    """It waits on its node's clock, and computes with the wall clock."""
    WALL_ALONE = auto()
    """It waits and computes on the wall clock: it moves on while that of its node stands still."""


@dataclass
class Known:
    """What need not be found out once more."""

    clocks: dict[str, FollowedClock] = field(default_factory=dict)
    """Of each node that served the action, which clock it follows."""
    longest_sec: float = math.inf
    """For how long of the robot's time the machine can drive that clock."""


@dataclass(frozen=True)
class Action:
    """What a check may do with an action that the student's node serves."""

    name: str
    """Absolute: '/move_arm'."""
    type: type
    """Its class, such as `arm_interfaces.action.MoveArm`."""
    known: Known = field(default_factory=Known, compare=False, repr=False)
    """What looks at it have shown so far."""

    def send_goal(self, goal: Any, *, cancel_after_sec: float | None = None) -> Outcome:
        """Send a goal, ask to cancel it after a while of wall time, and wait for its end.

        Raises CheckFailed where there is no server, one of another type, or more than one; and
        where no answer comes, or no end in RESULT_SEC of time that was free, with the reason.
        """
        with self.opened() as server:
            sent = server.send(goal)
            if not sent.is_accepted:
                return Outcome('rejected', None, ())
            if cancel_after_sec is not None:
                server.watcher.spin_for(cancel_after_sec)
                server.answer_to(server.ends.cancel(sent), what='the request to cancel')
            if not server.watcher.spin_until_free(sent.has_result, free_sec=RESULT_SEC):
                server.fail_without_end(
                    sent,
                    it=f'it {sent.status} in {RESULT_SEC:g} s',
                    none=f'none in {RESULT_SEC:g} s',
                )
            feedback = tuple(message for _, message in sent.feedback())
            return Outcome(sent.status, sent.result, feedback)

    @contextmanager
    def opened(self) -> Iterator[OpenAction]:
        """Meet the server, and see that no goal of earlier is left. Raises CheckFailed."""
        with Watcher(shared=True) as watcher:
            server = OpenAction(watcher, self.name, self.type)
            server.meet()
            try:
                yield server
            except CheckFailed:
                server.expect_alone()  # of two, nobody knows which one fails
                raise
            server.expect_alone()
