"""The arm behind `/move_arm`, and the clock by which a check watches it."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

from rclpy.qos import ReliabilityPolicy

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.actions.accepted_goals import (
    ends_too_soon,
    expect_accepted,
    never_moves,
)
from my_robot_basics.checks.actions.action_ends import TERMINAL, SentGoal
from my_robot_basics.checks.actions.open_action import OpenAction
from my_robot_basics.checks.arm.waits_in_vain import is_in_vain
from my_robot_basics.checks.clock.robot_time import DrivenTime, WallTime
from my_robot_basics.feedback.errors import CheckFailed, Starved

Pose = Sequence[float]
"""Positions of joint1 and joint2, in radians."""

STEP_NS = 50_000_000
"""The step of the robot's clock: half a period of feedback at 10 Hz."""
HASTE = 100.0
"""The speed, in rad/s, of a move that is not judged and only brings the arm to a position."""
HASTE_SEC = 4.0
"""How long such a move may take, in s of free time."""
RESULT_SEC = 1.0
"""How long after the terminal status the result may come, in s of free time."""
SETTLE_SEC, SOON_SEC = 3.0, 0.5
"""How long unjudged goals may take to end, and after which time to see whether waiting is in vain;
both in s of free time."""
SHORTER_PART, TURN = 0.35, 7.7
"""`goal` makes moves up to SHORTER_PART shorter than `longest_sec`. How much depends on the
position, in a way that only looks random; TURN is a factor for that."""
EARLY_PART = 0.8
"""A move that takes less than this part of its time was not made at the requested speed."""
STAYS_RAD = 0.005
"""An arm that is as near as this to its start has not moved."""
FEW, ON_SEC = 3, 1.0
"""A move goes on after its goal's end if FEW feedback messages come within ON_SEC."""
STALLED_PART = 0.05
"""A verdict is doubtful if processes waited for a processor for more than this part of a check."""


def goal(position: Pose, *, speed: float = 1.0) -> MoveArm.Goal:
    """A goal for `/move_arm`: positions in rad, the speed in rad/s."""
    return MoveArm.Goal(position=list(position), speed=speed)


def far_rad(start: Pose, end: Pose) -> float:
    """The distance of the joint that moves farther, in rad."""
    return max(abs(b - a) for a, b in zip(start, end, strict=True))


def faster_joint(start: Pose, end: Pose) -> int:
    """The number of the joint that moves farther, and so faster."""
    return max(range(len(end)), key=lambda number: abs(end[number] - start[number]))


@dataclass
class WatchedArm:
    """The connected server, with its arm at rest at `start`, and the clock that the check uses."""

    server: OpenAction
    time: DrivenTime | WallTime
    start: tuple[float, ...]
    """Where the arm is, in rad, if the server has done what it was asked to."""
    longest_sec: float = math.inf
    """The limit of a move's time; `goal` gives each move a different part of it."""
    lost_sec: float = 0.0
    """How much longer the last move took because the clock's steps were too coarse."""
    computes_on_wall: bool = False
    """Whether the server computes positions by the wall clock, whatever clock it sleeps on."""

    def goal(self, position: Pose, *, speed: float) -> MoveArm.Goal:
        """A goal with that speed, or with a higher one if the move would exceed `longest_sec`.

        Such moves take different times, to detect a server that takes the same time for each.
        """
        longest_sec = self.longest_sec * (1.0 - SHORTER_PART * (TURN * sum(position) % 1.0))
        return goal(position, speed=max(speed, far_rad(self.start, position) / longest_sec))

    def send(self, wanted: MoveArm.Goal, *others: MoveArm.Goal) -> SentGoal:
        """Send a goal, see `expect_accepted`. Raises CheckFailed, Inconclusive."""
        sent = expect_accepted(self.server, wanted, *others)
        if isinstance(self.time, DrivenTime):
            stamp = sent.answer.result().stamp
            self.time.expect_shown(stamp.sec * 10**9 + stamp.nanosec)
        return sent

    def seconds(self, sent: SentGoal) -> float:
        """How long an ended goal has taken, in seconds of the arm's clock."""
        # if the status changes several times in a moment, only the last change may arrive
        told = [at_ns for at_ns, status in sent.statuses() if status not in TERMINAL]
        began_ns = told[0] if told else sent.sent_ns
        over_ns = self.time.at_ns(sent.over_ns()) if sent.over_ns() else self.time.now_ns()
        return (over_ns - self.time.at_ns(began_ns)) / 1e9

    def seconds_since_sent(self, sent: SentGoal, wall_ns: int) -> float:
        """The time from sending a goal to that wall time, in seconds of the arm's clock."""
        return (self.time.at_ns(wall_ns) - self.time.at_ns(sent.sent_ns)) / 1e9

    def why_ended(self, sent: SentGoal) -> str:
        """What to try if a goal ended long before it should have, if that is known; or ''."""
        return self.server.log.raised(since_ns=sent.sent_ns) or self.why_too_soon(sent)

    def why_too_soon(self, sent: SentGoal) -> str:
        """What to try if feedback comes in ON_SEC after the end, or if nothing moved; or ''."""

        def goes_on() -> bool:
            return sum(sent.over_ns() < at_ns for at_ns, _ in sent.feedback()) >= FEW

        if sent.over_ns() and self.time.wait(goes_on, seconds=ON_SEC):
            return ends_too_soon()
        return self.why_unmoved(sent)

    def why_unmoved(self, sent: SentGoal) -> str:
        """What to try if a goal succeeded early, and its result is where the arm was; or ''."""
        early = sent.status == 'succeeded' and self.was_early(sent, sent.goal.position)
        if not early or sent.feedback() or not self.has_result(sent):
            return ''
        seen = list(sent.result.position)
        stays = len(seen) == len(self.start) and far_rad(self.start, seen) < STAYS_RAD
        return never_moves() if stays else ''

    def why_no_feedback(self, sent: SentGoal) -> str:
        """Why there may be no feedback on an ended goal, if that is known; or ''."""
        raised = self.server.raised.hint() or self.server.log.raised(since_ns=sent.sent_ns)
        return raised or self._why_unreliable() or self.why_too_soon(sent)

    def _why_unreliable(self) -> str:
        """What to try if the feedback's QoS is incompatible with an ActionClient; or ''."""
        node, name = self.server.watcher.node, f'{self.server.name}/_action/feedback'
        offered = {
            info.qos_profile.reliability for info in node.get_publishers_info_by_topic(name)
        }
        if offered <= {ReliabilityPolicy.RELIABLE}:
            return ''
        return (
            'the feedback is BEST_EFFORT, and an ActionClient asks for RELIABLE: leave '
            'feedback_pub_qos_profile out'
        )

    def has_result(self, sent: SentGoal) -> bool:
        """Wait for the result of an ended goal; return whether it came."""
        return self.server.watcher.spin_until_free(sent.has_result, free_sec=RESULT_SEC)

    def stalled_sec(self) -> float:
        """How long processes have waited for a processor so far; 0 on the robot's clock."""
        return self.time.stalled_sec() if isinstance(self.time, WallTime) else 0.0

    def doubt(self, sent: SentGoal | None = None, position: Pose = ()) -> type[CheckFailed]:
        """The exception for a fault: Starved if a busy machine may have caused it.

        A busy machine makes no move faster, so it cannot be the cause if the goal ended too early.
        """
        if sent is not None and self.was_early(sent, position):
            return CheckFailed
        if isinstance(self.time, WallTime):
            is_doubtful = self.time.stalled_sec() > STALLED_PART * self.time.wall_sec()
            return Starved if is_doubtful else CheckFailed
        return CheckFailed

    def was_early(self, sent: SentGoal, position: Pose) -> bool:
        """Whether a move to that position has ended far too early for its speed."""
        wanted_sec = far_rad(self.start, position) / sent.goal.speed
        return sent.is_over() and self.seconds(sent) < EARLY_PART * wanted_sec

    def settle(self) -> None:
        """End the goals that are still active, and let the execute callbacks return."""
        self._end_goals()
        self.server.wait_for_returns()

    def _end_goals(self) -> None:
        server, watcher = self.server, self.server.watcher
        watcher.spin_until(lambda: not server.has_active(), timeout_sec=0.05)
        if not server.has_active():
            return
        for cancel_first in False, True:
            if cancel_first:  # only then: a wrong server may remember the request, and stop again
                server.ends.cancel_all()
            began_ns = time.time_ns() if self.time.is_driven else 0
            for free_sec in SOON_SEC, SETTLE_SEC - SOON_SEC:
                if isinstance(self.time, DrivenTime):
                    self.time.push(lambda: not server.has_active(), free_sec=free_sec)
                else:
                    watcher.spin_until_free(lambda: not server.has_active(), free_sec=free_sec)
                if not server.has_active():
                    return
                if not cancel_first and self._is_last_in_vain(since_ns=began_ns):
                    break

    def _is_last_in_vain(self, *, since_ns: int) -> bool:
        """Whether waiting for the last accepted goal to end by itself is in vain."""
        last = self.server.accepted[-1:]
        return any(is_in_vain(sent, free_sec=SETTLE_SEC, since_ns=since_ns) for sent in last)
