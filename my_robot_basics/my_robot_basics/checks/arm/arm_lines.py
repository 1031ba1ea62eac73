"""How far positions are off a straight line, and why; all in radians."""

from collections.abc import Sequence

import numpy as np

from my_robot_basics.checks.values import joints

ON_LINE_RAD = 0.01
"""How far a position may be off the straight line."""


def parts_of_way(
    positions: np.ndarray, start: Sequence[float], end: Sequence[float]
) -> np.ndarray:
    """Which part of the way from `start` to `end` is done at each of the positions, a row each.

    The joint that moves farther shows it.
    """
    begin, ways = np.array(start), np.array(end) - np.array(start)
    joint = int(np.abs(ways).argmax())
    return np.asarray((positions[:, joint] - begin[joint]) / ways[joint])


def off_line(positions: np.ndarray, start: Sequence[float], end: Sequence[float]) -> np.ndarray:
    """How far each of the positions, a row each, is from the line from `start` to `end`."""
    begin, ways = np.array(start), np.array(end) - np.array(start)
    parts = np.clip(parts_of_way(positions, start, end), 0.0, 1.0)
    return np.asarray(np.abs(positions - (begin + parts[:, None] * ways)).max(axis=1))


def why_off_line(positions: np.ndarray, start: Sequence[float], end: Sequence[float]) -> str:
    """Advice: the known mistake that would bring the positions of two joints on the line."""
    mistakes = {
        'start from where the arm is, at each goal': (positions, (0.0, 0.0)),
        joints.SWAPPED: (positions[:, ::-1], start),
        **{why: (positions * signs, start) for why, signs in joints.SIGNS.items()},
    }
    for why, (corrected, begin) in mistakes.items():
        if off_line(corrected, begin, end).max() <= ON_LINE_RAD:
            return why
    return 'move both joints by the same part of their ways, so that they arrive together'
