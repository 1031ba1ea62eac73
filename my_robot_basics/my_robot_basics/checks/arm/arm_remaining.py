"""Whether the feedback of `/move_arm` says how far the arm still has to go."""

from collections.abc import Sequence

import numpy as np

from my_robot_basics.feedback.errors import fail

OFF_RAD, MOSTLY_OFF_RAD = 0.01, 0.003
"""How far off a message may be, and the median of all: if each has the value of the step before,
the median is off, too."""
ALIKE_RAD = 0.02
"""How near all messages have to be to what a mistake would publish."""
SIGNED = 'it is a distance: take the size of each difference, abs(…)'
LARGEST = (
    'it is the distance of the joint that is farthest away, in either direction: take the size '
    'of each difference, abs(…)'
)


def expect_remaining(
    told: np.ndarray, positions: np.ndarray, *, start: Sequence[float], end: Sequence[float]
) -> None:
    """Expect `remaining` to be what the joint that is farthest away still has to go, in rad.

    `told`: `remaining` of each message; `positions`: the joints' positions in each message, in
    rad. Raises CheckFailed.
    """
    ways = np.array(end) - positions
    left = np.abs(ways)
    wanted = left.max(axis=1)
    off = np.abs(told - wanted)
    if off.max() <= OFF_RAD and np.median(off) <= MOSTLY_OFF_RAD:
        return
    causes = {
        'it is what is left behind the step: compute it from the new position': wanted,
        'it is 0 all the time: fill in feedback.remaining': np.zeros(len(left)),
        'it is in radians, too': np.degrees(wanted),
        'it is the distance of the one joint that is farthest away, not the sum': left.sum(axis=1),
        SIGNED if told.min() < 0.0 else LARGEST: np.where(told < 0.0, told, ways.max(axis=1)),
        'it is the distance of the one joint that is farthest away': left.min(axis=1),
        'it is an angle, not the distance of both': np.hypot(*left.T),
        'it is what is left, not what is done': np.abs(positions - np.array(start)).max(axis=1),
    }
    found = [why for why, other in causes.items() if np.abs(told - other).max() <= ALIKE_RAD]
    worst = int(off.argmax())
    fail(
        expected=f'remaining {wanted[worst]:.3f} rad in the feedback',
        seen=f'{told[worst]:.3f}',
        hint=found[0] if found else 'compute it from the goal and the position of each step',
        cause='feedback.remaining is wrong',
    )
