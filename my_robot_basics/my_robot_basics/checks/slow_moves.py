"""A move of `/move_arm` that is far too slow, as its feedback tells: its end is not awaited."""

from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.checks.arm_progress import is_under_way
from my_robot_basics.checks.reported_speed import reported_speed
from my_robot_basics.checks.waits_in_vain import is_in_vain
from my_robot_basics.checks.watched_arm import Pose, WatchedArm, far_rad

CRAWL_PART = 1 / 8
"""An arm that tells so small a part of the speed asked for does not arrive in three times its
time, unless it gets faster: no right one is so slow for a quarter of the move."""


def wait_unless_it_crawls(
    arm: WatchedArm,
    sent: SentGoal,
    position: Pose,
    *,
    seconds: float,
    look_after_sec: float | None = None,
) -> bool:
    """Wait so many seconds of the arm's time for the end of a goal; whether it has come.

    An arm that crawls is waited for no longer, after so many of them, or as many as are wanted.
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
    """Whether the feedback tells of an arm on its way that is far too slow.

    On the wall clock, slower than a machine that is too busy makes one.
    """
    told = reported_speed(arm, sent, position).rad_per_sec
    if not told or told >= CRAWL_PART * sent.goal.speed or not is_under_way(arm, sent, position):
        return False
    return arm.time.is_driven or is_in_vain(sent, free_sec=left_sec)
