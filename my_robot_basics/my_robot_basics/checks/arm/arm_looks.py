"""Watch a server of `/move_arm` on the robot's clock, or on the wall clock if it ignores that.

A server is watched on the wall clock, with short moves, if it sleeps on wall time or blocks its
other callbacks during a move; also if it sleeps on its node's clock but computes with the wall
clock, which is a mistake.
"""

import math
from collections.abc import Callable
from typing import TypeVar

from my_robot_basics.checks.actions.actions import Action, FollowedClock
from my_robot_basics.checks.actions.goal_answers import Identity
from my_robot_basics.checks.arm.arm_progress import bring
from my_robot_basics.checks.arm.followed_clocks import FINE_NS, measure_clock, run_on_driven_clock
from my_robot_basics.checks.arm.missing_awaits import naming_missing_await
from my_robot_basics.checks.arm.watched_arm import STEP_NS, Pose, WatchedArm
from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.checks.clock.robot_time import WallTime
from my_robot_basics.feedback.hidden import is_validating

T = TypeVar('T')

BUSY_SEC = 6.0
"""The longest move on the robot's clock, in seconds, if the machine is too busy to drive more."""
WALL_SEC = 2.0
"""The longest move on the wall clock, in seconds."""
_clocks: dict[Identity, FollowedClock] = {}
"""The clock that each server follows, for the next grade cell, which checks the same server."""


def look(action: Action, body: Callable[[WatchedArm], T], *, start: Pose) -> T:
    """Return what `body` returns for the server, with the arm at `start` (rad).

    `body` runs on the robot's clock if the node follows it; else, or if that clock can't be
    driven, on the wall clock. Raises what `body` raises.
    """
    with naming_missing_await(), action.opened() as server:
        on_wall = WatchedArm(server, WallTime(server.watcher), tuple(start), WALL_SEC)
        bring(on_wall, start)
        clock = _followed_clock(action, on_wall)
        if clock == FollowedClock.DRIVEN_FINELY:  # a long move would have too many steps
            action.known.longest_sec = BUSY_SEC
        if clock in (FollowedClock.DRIVEN, FollowedClock.DRIVEN_FINELY):
            step_ns = STEP_NS if clock == FollowedClock.DRIVEN else FINE_NS
            for longest_sec in math.inf, BUSY_SEC:
                if longest_sec <= action.known.longest_sec:
                    try:
                        return run_on_driven_clock(
                            server, body, tuple(start), longest_sec=longest_sec, step_ns=step_ns
                        )
                    except Inconclusive:
                        action.known.longest_sec = BUSY_SEC
                        bring(on_wall, start)
        on_wall.time = WallTime(server.watcher)
        on_wall.computes_on_wall = clock in (FollowedClock.BOTH, FollowedClock.WALL_ALONE)
        try:
            return body(on_wall)
        finally:
            on_wall.settle()


def _followed_clock(action: Action, arm: WatchedArm) -> FollowedClock:
    """Which clock the server follows; measured once for each server."""
    server, name, clocks = arm.server.identity(), arm.server.node_name, action.known.clocks
    if name not in clocks:
        clocks[name] = _clocks.get(server) or measure_clock(arm)
    # on a busy machine, any clock may look like the wall clock: the grader measures again
    if clocks[name] != FollowedClock.WALL or is_validating():
        _clocks[server] = clocks[name]
    return clocks[name]
