"""An action that a student's node serves: send it a goal, and explain why no answer comes."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any

from my_robot_basics.checks.actions.open_action import OpenAction
from my_robot_basics.feedback.errors import CheckFailed
from my_robot_basics.graph.watcher import Watcher

RESULT_SEC = 10.0
"""How long `send_goal` waits for the end of a goal, in seconds of free time."""


def action(name: str, type_: type) -> 'Action':
    """Return the action with that absolute name and type, to send goals to its server.

    `outcome = action('/move_arm', MoveArm).send_goal(MoveArm.Goal(position=[0.5, 0.2]))`
    """
    return Action(name, type_)


@dataclass(frozen=True)
class Outcome:
    """How a goal ended."""

    status: str
    """'rejected', 'succeeded', 'canceled' or 'aborted'."""
    result: Any
    """The result's message; None if the goal was rejected."""
    feedback: tuple[Any, ...]
    """The feedback messages, in order."""


class FollowedClock(Enum):
    """Which clock an action server sleeps on and computes with."""

    DRIVEN = auto()
    """The clock of its node, which a check drives."""
    DRIVEN_FINELY = auto()
    """The same, if the server adds up steps that are much shorter than those of the check."""
    WALL = auto()
    """The wall clock, or a clock that a check can't drive during a move."""
    BOTH = auto()
    """It sleeps on its node's clock, but computes positions with the wall clock."""
    WALL_ALONE = auto()
    """It sleeps on and computes with the wall clock: it moves while its node's clock is held."""


@dataclass
class KnownServers:
    """What was found out about the servers of an action, so that it is not measured again."""

    clocks: dict[str, FollowedClock] = field(default_factory=dict)
    """The clock that a server follows, by the full name of its node."""
    longest_sec: float = math.inf
    """The longest move, in seconds of the robot's time, for which the clock can be driven."""


@dataclass(frozen=True)
class Action:
    """An action that the student's node serves."""

    name: str
    """The absolute name, such as '/move_arm'."""
    type: type
    """Its class, such as `arm_interfaces.action.MoveArm`."""
    known: KnownServers = field(default_factory=KnownServers, compare=False, repr=False)
    """What earlier checks have found out about it."""

    def send_goal(self, goal: Any, *, cancel_after_sec: float | None = None) -> Outcome:
        """Send a goal, wait for its end, and return how it ended.

        `cancel_after_sec`: after how long to request its cancellation, in seconds of wall time.
        Raises CheckFailed, with the reason, if there is no server, one of another type, or more
        than one, if no answer comes, or if the goal does not end in RESULT_SEC of free time.
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
        """Connect to the server, and expect that no earlier goal is left. Raises CheckFailed."""
        with Watcher(shared=True) as watcher:
            server = OpenAction(watcher, self.name, self.type)
            server.meet()
            try:
                yield server
            except CheckFailed:
                server.expect_alone()  # if there are two, either may have failed
                raise
            server.expect_alone()
