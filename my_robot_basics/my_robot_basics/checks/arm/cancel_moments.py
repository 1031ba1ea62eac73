"""When a goal is cancelled, so that no server is in time by chance."""

import math

HALF_SEC, JUST_AFTER_SEC = 0.5, 0.05
"""A server that looks for requests only twice or once a second is nearly as late as it can be if
one comes just after a half second of its move."""
WALL_PART = 0.4
"""The part of a move after which it is cancelled on the wall clock: enough of it has to be left on
a busy machine."""
STEP_SEC, LATE_STEPS = 0.05, 7
"""Moments on the robot's clock, in its steps, and how many steps late a server has to be for that
to be seen: it may stop 0.2 s and a step after the request."""
FIRST_PART, LAST_PART = 0.4, 0.68
"""Between these parts of a move on the robot's clock, one of these moments is chosen."""
OFTEN_STEPS, SELDOM_STEPS = (10, 20), (8, 12, 14, 16)
"""A server may look for requests every so many steps: twice or once a second, or every 0.4, 0.6,
0.7 or 0.8 s. At the moment that is chosen, as many of these servers as possible are late."""


def moment_to_cancel(move_sec: float, *, is_driven: bool) -> float:
    """Return when to cancel a move, in s after its start.

    `is_driven`: whether the move is watched on the robot's clock.
    """
    if is_driven:
        first = math.ceil(FIRST_PART * move_sec / STEP_SEC)
        last = math.floor(LAST_PART * move_sec / STEP_SEC)
        return max(range(first, max(first, last) + 1), key=_late_servers) * STEP_SEC
    seconds = WALL_PART * move_sec
    nearest = round(seconds / HALF_SEC) * HALF_SEC + JUST_AFTER_SEC
    return seconds if seconds < HALF_SEC else nearest


def _late_servers(moment: int) -> tuple[int, int]:
    """How many servers that look at intervals would be late, the usual intervals first."""
    often, seldom = (
        sum(-moment % interval >= LATE_STEPS for interval in intervals)
        for intervals in (OFTEN_STEPS, SELDOM_STEPS)
    )
    return often, seldom
