"""Drive a long move in coarse steps of the clock, if its server keeps pace with them.

A server that computes the position from its clock keeps pace; one that adds up steps falls behind.
"""

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.arm.slow_moves import wait_unless_it_crawls
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, far_rad, faster_joint
from my_robot_basics.checks.clock.robot_time import DrivenTime

COARSE_NS = 250_000_000
"""How far a coarse step moves the clock."""
LONG_SEC = 8.0
"""Only moves that take longer are driven in coarse steps."""
BEGIN_SEC, END_SEC, END_PART = 1.0, 1.0, 0.03
"""How many seconds at the start and at the end of a move are driven in fine steps; at the end, at
least END_PART of the move."""
BEHIND_SEC = 0.1
"""If a server falls behind by more than this in one coarse step, it gets fine ones."""
REPORT_SEC = 0.2
"""How long the next feedback may take, in seconds of the robot's time."""
TELLS_PART = 0.25
"""After this part of a long move, its feedback shows whether the arm is far too slow."""


def wait_for_end(arm: WatchedArm, sent: SentGoal, position: Pose, *, seconds: float) -> bool:
    """Wait for the end of a goal, `seconds` of the arm's time; return whether it came.

    Then `arm.lost_sec` is how far the server fell behind because of a step that was too coarse.
    """
    arm.lost_sec = 0.0
    wanted_sec = far_rad(arm.start, position) / sent.goal.speed
    if not isinstance(arm.time, DrivenTime) or not LONG_SEC < wanted_sec <= seconds:
        return wait_unless_it_crawls(arm, sent, position, seconds=seconds)
    time, began_ns, fine_ns = arm.time, arm.time.now_ns(), arm.time.step_ns
    try:
        if time.wait(sent.is_over, seconds=BEGIN_SEC):
            return True
        if _keeps_pace(arm, time, sent, position):
            last_sec = max(END_SEC, END_PART * wanted_sec)
            left_sec = wanted_sec - last_sec - (time.now_ns() - began_ns) / 1e9
            time.step_ns = COARSE_NS
            time.wait(sent.is_over, seconds=left_sec)
    finally:
        time.step_ns = fine_ns
    passed_sec = (time.now_ns() - began_ns) / 1e9
    return wait_unless_it_crawls(
        arm,
        sent,
        position,
        seconds=seconds - passed_sec,
        look_after_sec=max(0.0, TELLS_PART * wanted_sec - passed_sec),
    )


def _keeps_pace(arm: WatchedArm, time: DrivenTime, sent: SentGoal, position: Pose) -> bool:
    """Whether the feedback has advanced as far as the clock, also in one coarse step.

    A loop that adds up steps of three times its sleep is ahead of the clock in fine steps, and
    nearly keeps pace with coarse ones, which it would seem to need for its way.
    """
    before = _last_report(arm, sent, position)
    if before is None or _ahead_sec(arm, sent, before) > BEHIND_SEC:
        return False
    fine_ns, time.step_ns = time.step_ns, COARSE_NS
    time.wait(sent.is_over, seconds=COARSE_NS / 1e9)
    time.step_ns, count = fine_ns, sent.feedback_count()
    time.wait(lambda: sent.is_over() or sent.feedback_count() > count, seconds=REPORT_SEC)
    after = _last_report(arm, sent, position)
    if after is None:
        return False
    passed_sec, gone_rad = after[0] - before[0], after[1] - before[1]
    behind_sec = passed_sec - gone_rad / sent.goal.speed
    if behind_sec > BEHIND_SEC:
        arm.lost_sec = min(behind_sec, COARSE_NS / 1e9)
    return abs(behind_sec) <= BEHIND_SEC


def _ahead_sec(arm: WatchedArm, sent: SentGoal, report: tuple[float, float]) -> float:
    """How far a report is ahead of the time since its goal was sent, in s."""
    at_sec, gone_rad = report
    return gone_rad / sent.goal.speed - (at_sec - arm.time.at_ns(sent.sent_ns) / 1e9)


def _last_report(arm: WatchedArm, sent: SentGoal, position: Pose) -> tuple[float, float] | None:
    """When the last feedback was sent, in s, and how far the faster joint had gone, in rad."""
    found = sent.feedback()
    if not found or len(found[-1][1].position) != len(position):
        return None
    ways = [b - a for a, b in zip(arm.start, position, strict=True)]
    joint = faster_joint(arm.start, position)
    sent_ns, message = found[-1]
    gone = (message.position[joint] - arm.start[joint]) / ways[joint] * abs(ways[joint])
    return arm.time.at_ns(sent_ns) / 1e9, gone
