"""Which publishers have followed the robot's clock: they need not show again that they do."""

from my_robot_basics.checks.recorder import Recorder

AGAIN_SEC = 0.1
"""So long does the clock stand still for who has followed it: a message may be under way."""

_followers: set[tuple[int, ...]] = set()
"""Endpoint GIDs: a publisher that is made anew has another one."""


def remember(recorder: Recorder) -> None:
    """All that publish there have been recorded on the robot's clock."""
    _followers.update(recorder.endpoint_gids())


def hold_sec(recorder: Recorder, seconds: float) -> float:
    """How long to let the clock stand still before a recording, instead of so many seconds."""
    gids = recorder.endpoint_gids()
    return min(seconds, AGAIN_SEC) if gids and gids <= _followers else seconds
