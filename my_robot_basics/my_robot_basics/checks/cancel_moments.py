"""When a goal is cancelled, so that no server is in time by chance."""

HALF_SEC, JUST_AFTER_SEC = 0.5, 0.05
"""A server that looks for requests only twice or once a second is nearly as late as it can be if
one comes just after a half second of its move."""


def just_after_half_second(seconds: float) -> float:
    """Return the nearest such moment; `seconds` itself if it is before the first half second."""
    nearest = round(seconds / HALF_SEC) * HALF_SEC + JUST_AFTER_SEC
    return seconds if seconds < HALF_SEC else nearest
