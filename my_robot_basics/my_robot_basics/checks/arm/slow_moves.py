"""Stop waiting for a move of `/move_arm` if its feedback shows that it is far too slow."""

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.arm.arm_progress import is_under_way
from my_robot_basics.checks.arm.reported_speed import reported_speed
from my_robot_basics.checks.arm.waits_in_vain import is_in_vain
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, far_rad

CRAWL_PART = 1 / 8
"""An arm whose feedback shows less than this part of the requested speed does not arrive within
three times its time unless it gets faster. No right arm is this slow for a quarter of a move."""


def wait_unless_it_crawls(
    arm: WatchedArm,
    sent: SentGoal,
    position: Pose,
    *,
    seconds: float,
    look_after_sec: float | None = None,
) -> bool:
    """Wait up to `seconds` of the arm's time for a goal to end; return whether it has ended.

    After `look_after_sec` (by default, the time that the move should take), it stops waiting if
    the arm crawls.
    """
    if look_after_sec is None:
        look_after_sec = far_rad(arm.start, position) / sent.goal.speed
    look_after_sec = min(look_after_sec, seconds)
    if arm.time.wait(sent.is_over, seconds=look_after_sec):
        return True
    left_sec = seconds - look_after_sec
    if _crawls(arm, sent, position, left_sec=left_sec):
        return False
    return arm.time.wait(sent.is_over, seconds=left_sec)


def _crawls(arm: WatchedArm, sent: SentGoal, position: Pose, *, left_sec: float) -> bool:
    """Whether the feedback shows an arm that moves far too slowly.

    On the wall clock, it must be slower than a busy machine can make a right arm.
    """
    told = reported_speed(arm, sent, position).rad_per_sec
    if not told or told >= CRAWL_PART * sent.goal.speed or not is_under_way(arm, sent, position):
        return False
    return arm.time.is_driven or is_in_vain(sent, free_sec=left_sec)
