"""When a goal is cancelled, so that no server is in time by chance."""

import math

HALF_SEC, JUST_AFTER_SEC = 0.5, 0.05
"""A server that looks for requests only twice or once a second is nearly as late as it can be if
one comes just after a half second of its move."""
DRIVEN_PART, WALL_PART = 0.68, 0.4
"""The part of a move after which it is cancelled. On the robot's clock, the visible check, whose
move takes 6 s, cancels just after 4 s, so that a server that looks every 0.4 s is late, too. On
the wall clock, enough of the move has to be left on a busy machine."""


def moment_to_cancel(move_sec: float, *, is_driven: bool) -> float:
    """Return when to cancel a move, in s after its start: just after a half second, if it can be.

    `is_driven`: whether the move is watched on the robot's clock.
    """
    if is_driven:
        half_seconds = math.floor(DRIVEN_PART * move_sec / HALF_SEC)
    else:
        half_seconds = round(WALL_PART * move_sec / HALF_SEC)
    seconds = WALL_PART * move_sec
    return seconds if seconds < HALF_SEC else half_seconds * HALF_SEC + JUST_AFTER_SEC
