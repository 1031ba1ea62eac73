"""Which publishers have followed the robot's clock, or ignored it: they need not show it again."""

from my_robot_basics.checks.recorder import Recorder

AGAIN_SEC = 0.1
"""So long does the clock stand still for who has followed it: a message may be under way."""

_followers: set[tuple[int, ...]] = set()
_others: set[tuple[int, ...]] = set()
"""Endpoint GIDs: a publisher that is made anew has another one."""


def remember(recorder: Recorder) -> None:
    """All that publish there have been recorded on the robot's clock."""
    _followers.update(recorder.endpoint_gids())


def remember_ignoring(recorder: Recorder) -> None:
    """All that publish there went on while the robot's clock stood still."""
    _others.update(recorder.endpoint_gids())


def ignore(recorder: Recorder) -> bool:
    """Whether all that publish there were seen to ignore the robot's clock."""
    gids = recorder.endpoint_gids()
    return bool(gids) and gids <= _others


def hold_sec(recorder: Recorder, seconds: float) -> float:
    """How long to let the clock stand still before a recording, instead of so many seconds."""
    gids = recorder.endpoint_gids()
    return min(seconds, AGAIN_SEC) if gids and gids <= _followers else seconds
