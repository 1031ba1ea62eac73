"""Which publishers were seen to ignore the robot's clock: they need not show it again."""

from my_robot_basics.checks.recorder import Recorder

_ignoring: set[tuple[int, ...]] = set()
"""Endpoint GIDs: a publisher that is made anew has another one."""


def remember(recorder: Recorder) -> None:
    """All that publish there went on while the robot's clock stood still."""
    _ignoring.update(recorder.endpoint_gids())


def is_known(recorder: Recorder) -> bool:
    """Whether all that publish there were seen to ignore the robot's clock."""
    gids = recorder.endpoint_gids()
    return bool(gids) and gids <= _ignoring
