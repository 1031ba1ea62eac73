"""Labels in a picture, placed where they hide as little as possible."""

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

TURNS_DEG = (0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180)
"""Directions to try for a label, relative to its preferred direction, the nearest first."""
POINTS = 60
"""How many points represent a straight line."""
MARGIN = 0.35
"""Free space around a label, in label heights: what the widest line needs on each side."""


@dataclass(frozen=True)
class PictureLabel:
    """A label beside a point of the picture."""

    words: 'Text'
    at: np.ndarray
    """The point, (x, y) in metres."""
    distance: float
    """From that point, in metres."""
    direction_deg: float
    """The preferred direction of the label, seen from the point."""


def points_along(corners: ArrayLike) -> np.ndarray:
    """Return points close to each other on the line through `corners`: rows (x, y) in metres."""
    corners = np.asarray(corners, dtype=float).reshape(-1, 2)
    sides = pairwise(corners)
    return np.concatenate([corners, *(np.linspace(*side, POINTS) for side in sides)])


def place(label: PictureLabel, *, avoid: np.ndarray) -> np.ndarray:
    """Place a label where it hides the fewest points of `avoid`; return points on its outline."""
    size = _size(label.words)
    spots = [_spot(label, turn_deg, size) for turn_deg in TURNS_DEG]
    hidden = [_count(low, low + size, avoid) for low in spots]
    low = spots[hidden.index(min(hidden))]
    label.words.set_position((low[0], low[1]))
    (left, bottom), (right, top) = low.tolist(), (low + size).tolist()
    corners = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
    return points_along(corners)


def _size(words: 'Text') -> np.ndarray:
    """Return the width and height of a drawn label, in metres of the axes."""
    figure, axes = words.get_figure(), words.axes
    assert figure is not None  # it is drawn in one
    assert axes is not None
    renderer = cast('FigureCanvasAgg', figure.canvas).get_renderer()
    drawn = axes.transData.inverted().transform(words.get_window_extent(renderer))
    return drawn[1] - drawn[0]


def _spot(label: PictureLabel, turn_deg: float, size: np.ndarray) -> np.ndarray:
    """Return the lower left corner of the label if it is placed in that direction."""
    angle = np.radians(label.direction_deg + turn_deg)
    towards = np.array([np.cos(angle), np.sin(angle)])
    on_the_left = size[0] if towards[0] < -1e-9 else 0.0
    return label.at + label.distance * towards - (on_the_left, size[1] / 2)


def _count(low: np.ndarray, high: np.ndarray, points: np.ndarray) -> int:
    """Count the points that are in that box, or within MARGIN of it."""
    margin = MARGIN * (high[1] - low[1])
    return np.all((points > low - margin) & (points < high + margin), axis=1).sum()
