"""A picture of an action's goal: the states that it has been in, and the arm that it moves."""

from collections.abc import Sequence
from typing import Any

from my_robot_basics.drawing.arm import ArmPicture
from my_robot_basics.two_link_kinematics import L1, L2

PLACES = {
    'ACCEPTED': (1.6, 2.6),
    'EXECUTING': (5.0, 2.6),
    'SUCCEEDED': (8.4, 2.6),
    'ABORTED': (8.4, 3.7),
    'CANCELING': (5.0, 1.5),
    'CANCELED': (8.4, 1.5),
}
"""The centre (x, y) of each goal state in the diagram."""
WAYS = (
    *(('ACCEPTED', 'EXECUTING'), ('EXECUTING', 'SUCCEEDED'), ('EXECUTING', 'ABORTED')),
    *(('EXECUTING', 'CANCELING'), ('CANCELING', 'CANCELED'), ('CANCELING', 'SUCCEEDED')),
)
"""The state transitions that are drawn: (from, to)."""
WIDTH, HEIGHT = 10.0, 4.3
BOX = (1.1, 0.35)
"""Half the width and half the height of the largest frame around a state."""
BAR = (1.0, 0.2, 8.0, 0.4)
"""Left, bottom, width and height of the bar that shows which part of the motion is done."""
STATES_INCHES = 2.0
REACHED, NOW, NOT_YET = '#56b4e9', '#e69f00', 'white'
"""Colours of a former state, of the current state, and of one that the goal was not in yet."""


class GoalPicture(ArmPicture):
    """The states of one goal, above the arm."""

    def __init__(self, *, l1: float = L1, l2: float = L2) -> None:
        """Make room above the arm, and draw all states there."""
        super().__init__(l1=l1, l2=l2)
        width, arm_inches = self._figure.get_size_inches()
        height = arm_inches + STATES_INCHES
        self._figure.set_size_inches(width, height)
        arm = self._axes.get_position(original=True)
        scale = arm_inches / height
        self._axes.set_position((arm.x0, arm.y0 * scale, arm.width, arm.height * scale))
        self._axes.apply_aspect()
        self._states = axes = self._figure.add_axes(
            (0.0, scale, 1.0, 1.0 - scale), xlim=(0, WIDTH), ylim=(0, HEIGHT)
        )
        axes.set_axis_off()
        for start, stop in WAYS:
            ends = _edge(stop, towards=start), _edge(start, towards=stop)
            axes.annotate('', *ends, arrowprops={'arrowstyle': '-|>', 'shrinkA': 0, 'shrinkB': 0})
        self._boxes = {state: self._box(state, *place) for state, place in PLACES.items()}
        left, bottom, bar_width, bar_height = BAR
        axes.bar(left, bar_height, bar_width, bottom, align='edge', color='white', ec='black')
        self._bar = axes.bar(left, bar_height, 0.0, bottom, align='edge', color=NOW)[0]
        self._remaining = axes.text(WIDTH / 2, bottom + bar_height + 0.1, '', ha='center')
        self._remaining.set_fontsize(9)

    def states(self, states: Sequence[str]) -> None:
        """Colour the states that a goal has been in; the last one is its current state."""
        for state, box in self._boxes.items():
            is_now = state == (states[-1] if states else None)
            face = NOW if is_now else REACHED if state in states else NOT_YET
            box.set_bbox(self._frame_of(face, line=2.5 if is_now else 1.0))
            box.set_fontweight('bold' if is_now else 'normal')

    def progress(self, part: float, text: str) -> None:
        """Show which part of the motion is done, from 0 to 1, and what remains in words."""
        self._bar.set_width(BAR[2] * min(1.0, max(0.0, part)))
        self._remaining.set_text(text)

    def _box(self, state: str, x: float, y: float) -> Any:
        return self._states.text(
            *(x, y, state), ha='center', va='center', fontsize=9, bbox=self._frame_of(NOT_YET)
        )

    @staticmethod
    def _frame_of(face: str, *, line: float = 1.0) -> dict[str, Any]:
        return {'boxstyle': 'round,pad=0.4', 'facecolor': face, 'edgecolor': 'black', 'lw': line}


def _edge(state: str, *, towards: str) -> tuple[float, float]:
    """Return the point where the arrow between two states meets the frame of `state`."""
    (x, y), (to_x, to_y) = PLACES[state], PLACES[towards]
    part = min(half / abs(way) for half, way in zip(BOX, (to_x - x, to_y - y), strict=True) if way)
    return x + part * (to_x - x), y + part * (to_y - y)
