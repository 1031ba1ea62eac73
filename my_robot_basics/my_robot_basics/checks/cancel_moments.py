"""When a goal is cancelled, so that no server is in time by chance."""

import math

HALF_SEC, JUST_AFTER_SEC = 0.5, 0.05
"""A server that looks for requests only twice or once a second is nearly as late as it can be if
one comes just after a half second of its move."""


def just_after_half_second(seconds: float) -> float:
    """Return a moment near `seconds`, just after a half second; `seconds` before the first one."""
    halves = math.floor(seconds / HALF_SEC)
    return halves * HALF_SEC + JUST_AFTER_SEC if halves else seconds
