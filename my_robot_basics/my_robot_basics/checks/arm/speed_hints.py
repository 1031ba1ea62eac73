"""What to try if a move of `/move_arm` takes too long, or not long enough."""

import math

from my_robot_basics.checks.arm.arm_progress import BY_TIME
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm

JUMP_SEC = 0.3
"""If a move takes no longer than this, the arm jumps to its goal."""
ALIKE = 0.03
"""How near a wrong speed has to be to that of a known mistake, as a part of it."""
JUMPS = 'the arm jumps: move it a little in each step, by speed × the time of the step'
BOTH = 'both joints move at once: start and arrive together'
FROM_HERE = 'start from where the arm is, at each goal'
AT_ONCE = (
    'the arm moves at the right speed: let it rest nowhere, and end the goal once it is there'
)


def why_speed(
    arm: WatchedArm, position: Pose, speed: float, *, seconds: float, rests: bool = False
) -> str:
    """Advice for a move at `speed` (rad/s) that took `seconds`.

    `rests`: its feedback shows the right speed, so that it took too long where the arm stood.
    """
    product = seconds * speed
    ways = [abs(b - a) for a, b in zip(arm.start, position, strict=True)]
    causes = {
        math.radians(max(ways)): 'the speed is in rad/s already, as the positions are in rad',
        math.degrees(max(ways)): 'the speed is in rad/s already, as the positions are in rad',
        math.hypot(*ways): 'the speed is that of the faster joint, not of both together',
        sum(ways): BOTH,
        min(ways): 'the speed is that of the joint that has farther to go',
        max(map(abs, position)): FROM_HERE,
    }
    wrong = {rad: why for rad, why in causes.items() if abs(rad - max(ways)) > ALIKE * rad}
    found = [why for rad, why in wrong.items() if abs(product - rad) <= ALIKE * rad]
    if rests:
        return BOTH if BOTH in found else AT_ONCE
    if found:
        return found[0]
    if seconds <= JUMP_SEC:
        return JUMPS
    return BY_TIME
