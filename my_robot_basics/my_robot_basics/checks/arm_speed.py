"""Whether a move took as long as it should, whatever the server waits for between its steps."""

import math
from typing import NoReturn

from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.checks.robot_time import DrivenTime
from my_robot_basics.checks.watched_arm import Pose, WatchedArm, far_rad
from my_robot_basics.feedback.errors import fail

TOLERANCE, WALL_TOLERANCE = 0.02, 0.05
SLACK_SEC = 0.12
"""So much more or less is one step of the server's, and one of the clock."""
FINEST = 0.0005, 0.45
"""A step of the clock, and for how long the arm moves, in seconds: a server whose sleeps are no
multiple of the clock's steps sleeps longer than it means to, and less so with finer ones. …"""
FINER = 0.002, 4.0
"""… Where no feedback tells the speed, the move has to be longer."""
MOST_TIMES = 3.0
FEWEST = 4
"""So much feedback tells a speed."""
JUMP_SEC = 0.3
"""Who needs no longer does not move at a speed."""
ALIKE = 0.03
"""So near is a wrong speed to the one that a mistake makes."""


def expect_speed(arm: WatchedArm, sent: SentGoal, position: Pose) -> None:
    """A goal that was reached has taken as long as its speed asks for. Raises CheckFailed."""
    wanted_sec = far_rad(arm.start, position) / sent.goal.speed
    seconds = arm.seconds(sent)
    tolerance = TOLERANCE if arm.time.is_driven else WALL_TOLERANCE
    if abs(seconds - wanted_sec) <= tolerance * wanted_sec + SLACK_SEC:
        return
    is_slow = wanted_sec < seconds
    if is_slow and arm.time.is_driven and _is_right_in_finer_steps(arm, sent, position):
        return
    _fail_speed(arm, sent, position, seconds=seconds, wanted_sec=wanted_sec)


def _is_right_in_finer_steps(arm: WatchedArm, sent: SentGoal, position: Pose) -> bool:
    assert isinstance(arm.time, DrivenTime)
    step_sec, seconds = FINEST if _speed_seen(arm, sent, position) else FINER
    arm.move(arm.start)
    former_ns, arm.time.step_ns = arm.time.step_ns, round(step_sec * 1e9)
    try:
        return abs(_slowness(arm, position, seconds=seconds) - 1.0) <= TOLERANCE
    finally:
        arm.time.step_ns = former_ns


def _slowness(arm: WatchedArm, position: Pose, *, seconds: float) -> float:
    """How many times as long as it should a move takes that should take so many seconds."""
    sent = arm.send(arm.goal(position, speed=far_rad(arm.start, position) / seconds))
    if not arm.time.wait(sent.is_over, seconds=MOST_TIMES * seconds):
        return MOST_TIMES
    seen = _speed_seen(arm, sent, position)
    if seen:
        return sent.goal.speed / seen
    off_sec = arm.seconds(sent) - seconds
    return 1.0 + math.copysign(max(0.0, abs(off_sec) - SLACK_SEC), off_sec) / seconds


def _speed_seen(arm: WatchedArm, sent: SentGoal, position: Pose) -> float:
    """The speed of the faster joint, in rad/s, as feedback tells it; 0 where it does not."""
    ways = [b - a for a, b in zip(arm.start, position, strict=True)]
    joint = max(range(len(ways)), key=lambda number: abs(ways[number]))
    on_the_way = []
    for sent_ns, message in sent.feedback():
        if len(message.position) == len(ways):
            part = (message.position[joint] - arm.start[joint]) / ways[joint]
            if 0.0 < part < 1.0:
                on_the_way.append((arm.time.at_ns(sent_ns) / 1e9, part * abs(ways[joint])))
    if len(on_the_way) < FEWEST:
        return 0.0
    (first_sec, first_rad), (last_sec, last_rad) = on_the_way[0], on_the_way[-1]
    passed_sec = last_sec - first_sec
    return (last_rad - first_rad) / passed_sec if passed_sec > 0.0 else 0.0


def _fail_speed(
    arm: WatchedArm, sent: SentGoal, position: Pose, *, seconds: float, wanted_sec: float
) -> NoReturn:
    far = far_rad(arm.start, position)
    fail(
        expected=f'{wanted_sec:.1f} s for {far:.2f} rad at {sent.goal.speed:.3g} rad/s',
        seen=f'{seconds:.1f} s',
        hint=_why_speed(arm, position, seconds * sent.goal.speed, seconds=seconds),
        cause='the arm is too slow' if wanted_sec < seconds else 'the arm is too fast',
        doubt=arm.doubt(),
    )


def _why_speed(arm: WatchedArm, position: Pose, product: float, *, seconds: float) -> str:
    """What to try; `product` is the time that it took times the speed asked for, in rad."""
    ways = [abs(b - a) for a, b in zip(arm.start, position, strict=True)]
    causes = {
        math.radians(max(ways)): 'the speed is in rad/s already, as the positions are in rad',
        math.degrees(max(ways)): 'the speed is in rad/s already, as the positions are in rad',
        math.hypot(*ways): 'the speed is that of the faster joint, not of both together',
        sum(ways): 'both joints move at once: start and arrive together',
        min(ways): 'the speed is that of the joint that has farther to go',
        max(map(abs, position)): 'start from where the arm is, at each goal',
    }
    found = [why for rad, why in causes.items() if abs(product - rad) <= ALIKE * rad]
    if found:
        return found[0]
    if seconds <= JUMP_SEC:
        return 'the arm jumps: move it a little in each step, by speed × the time of the step'
    return "in each step, move by speed × the time that passed, on the node's own clock"
