"""The arm behind `/move_arm`, and the time in which a check watches it."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

from rclpy.qos import ReliabilityPolicy

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.accepted_goals import accepted, ends_too_soon
from my_robot_basics.checks.action_ends import TERMINAL, SentGoal
from my_robot_basics.checks.open_action import OpenAction
from my_robot_basics.checks.robot_time import DrivenTime, WallTime
from my_robot_basics.checks.waits_in_vain import is_in_vain
from my_robot_basics.feedback.errors import CheckFailed, Starved

Pose = Sequence[float]
"""Positions of joint1 and joint2, in radians."""

STEP_NS = 50_000_000
"""Steps of the robot's clock: two of them between feedback at 10 Hz."""
HASTE = 100.0
"""Speed, in rad/s, of a move that only brings the arm somewhere."""
HASTE_SEC = 4.0
"""It may take so long, of free time."""
RESULT_SEC = 1.0
"""How long a result may come behind the status, of free time."""
SETTLE_SEC, SOON_SEC = 3.0, 0.5
"""How long goals may take to end when nobody looks any more, of free time, and when to
see whether that is in vain."""
SHORTER_PART, TURN = 0.35, 7.7
"""Short moves are shorter than the longest by up to that part: which, comes of the position."""
EARLY_PART = 0.8
"""A move that is over sooner was not made at its speed."""
FEW, ON_SEC = 3, 1.0
"""So much feedback within that time after the end of a goal tells of a move that goes on."""
STALLED_PART = 0.05
"""So much of a look in which processes had to wait for a processor makes it a doubtful one."""


def goal(position: Pose, *, speed: float = 1.0) -> MoveArm.Goal:
    """A goal for `/move_arm`: positions in rad, the speed in rad/s."""
    return MoveArm.Goal(position=list(position), speed=speed)


def far_rad(start: Pose, end: Pose) -> float:
    """How far the faster joint has to go, in rad."""
    return max(abs(b - a) for a, b in zip(start, end, strict=True))


@dataclass
class WatchedArm:
    """The server, met, with its arm at rest at `start`, and the time in which it is watched."""

    server: OpenAction
    time: DrivenTime | WallTime
    start: tuple[float, ...]
    """Where the arm is, in rad, if the server does what it was asked to."""
    longest_sec: float = math.inf
    """No move takes longer, and each another part of it."""
    lost_sec: float = 0.0
    """So much longer the last move took because of a step of the clock that was too coarse."""
    computes_on_wall: bool = False
    """Whether the server computes with the wall clock, whichever it waits on."""

    def goal(self, position: Pose, *, speed: float) -> MoveArm.Goal:
        """A goal with that speed, or with a higher one where the move has to be short.

        Short moves differ in their time: a server that takes the same for each is not right.
        """
        longest_sec = self.longest_sec * (1.0 - SHORTER_PART * (TURN * sum(position) % 1.0))
        return goal(position, speed=max(speed, far_rad(self.start, position) / longest_sec))

    def send(self, wanted: MoveArm.Goal, *others: MoveArm.Goal) -> SentGoal:
        """Send a goal that has to be accepted, or another. Raises CheckFailed, Inconclusive."""
        sent = accepted(self.server, wanted, *others)
        if isinstance(self.time, DrivenTime):
            stamp = sent.answer.result().stamp
            self.time.expect_shown(stamp.sec * 10**9 + stamp.nanosec)
        return sent

    def seconds(self, sent: SentGoal) -> float:
        """How long a goal that is over has taken, in seconds of this time."""
        # of several statuses in a moment, the last one alone may arrive
        told = [at_ns for at_ns, status in sent.statuses() if status not in TERMINAL]
        began_ns = told[0] if told else sent.sent_ns
        over_ns = self.time.at_ns(sent.over_ns()) if sent.over_ns() else self.time.now_ns()
        return (over_ns - self.time.at_ns(began_ns)) / 1e9

    def seconds_since_sent(self, sent: SentGoal, wall_ns: int) -> float:
        """How long after a goal was sent that wall time was, in seconds of this time."""
        return (self.time.at_ns(wall_ns) - self.time.at_ns(sent.sent_ns)) / 1e9

    def why_too_soon(self, sent: SentGoal) -> str:
        """What to try where feedback goes on after the server has told how the goal ended; or ''.

        It waits for that.
        """

        def goes_on() -> bool:
            return sum(sent.over_ns() < at_ns for at_ns, _ in sent.feedback()) >= FEW

        if not sent.over_ns() or not self.time.wait(goes_on, seconds=ON_SEC):
            return ''
        return ends_too_soon()

    def why_no_feedback(self, sent: SentGoal) -> str:
        """Why there may be no feedback on a goal that is over, where that is known; or ''."""
        raised = self.server.raised.hint() or self.server.log.raised(since_ns=sent.sent_ns)
        return raised or self._why_unreliable() or self.why_too_soon(sent)

    def _why_unreliable(self) -> str:
        """What to try where its feedback has a QoS with which none arrives; or ''."""
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
        """Whether the result comes, now that the goal is over."""
        return self.server.watcher.spin_until_free(sent.has_result, free_sec=RESULT_SEC)

    def stalled_sec(self) -> float:
        """For how long the machine was too busy during this look; 0 on the robot's clock."""
        return self.time.stalled_sec() if isinstance(self.time, WallTime) else 0.0

    def doubt(self, sent: SentGoal | None = None, position: Pose = ()) -> type[CheckFailed]:
        """What to raise for what a machine that is too busy may have done.

        It makes no move to a position faster: with a goal that was over too early it has nothing
        to do.
        """
        if sent is not None and sent.is_over():
            wanted_sec = far_rad(self.start, position) / sent.goal.speed
            if self.seconds(sent) < EARLY_PART * wanted_sec:
                return CheckFailed
        if isinstance(self.time, WallTime):
            is_doubtful = self.time.stalled_sec() > STALLED_PART * self.time.wall_sec()
            return Starved if is_doubtful else CheckFailed
        return CheckFailed

    def settle(self) -> None:
        """Bring each goal to its end that has none yet, and let the server return."""
        self._end_goals()
        self.server.wait_for_returns()

    def _end_goals(self) -> None:
        server, watcher = self.server, self.server.watcher
        watcher.spin_until(lambda: not server.has_active(), timeout_sec=0.05)
        if not server.has_active():
            return
        for cancel_first in False, True:
            if cancel_first:  # last: it may leave a wrong server with a wish to stop
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
        """Whether the last goal does not end by itself while goals are brought to their end."""
        last = self.server.accepted[-1:]
        return any(is_in_vain(sent, free_sec=SETTLE_SEC, since_ns=since_ns) for sent in last)
