"""Which publishers ignore the robot's clock, so that checks need not measure it again."""

from my_robot_basics.checks.recordings.recorder import Recorder

_ignoring: set[tuple[int, ...]] = set()
"""Their GIDs; a publisher that is created again has another GID."""


def remember(recorder: Recorder) -> None:
    """Remember that all publishers of the recorder's topic ignore the robot's clock."""
    _ignoring.update(recorder.endpoint_gids())


def is_known(recorder: Recorder) -> bool:
    """Whether all publishers of the recorder's topic are known to ignore the robot's clock."""
    gids = recorder.endpoint_gids()
    return bool(gids) and gids <= _ignoring
