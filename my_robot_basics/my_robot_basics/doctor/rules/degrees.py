"""Messages arrive, and angles look like degrees instead of radians."""

import math
from collections.abc import Iterator
from typing import Any

from my_robot_basics.doctor.evidence import Evidence, Finding

TURN_DEG = 360.0
_TURNS_FOREVER = ('wheel', 'continuous', 'propeller', 'rotor')
"""Parts of the names of continuous joints, which may be at many radians."""


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name the largest position if it is more than a turn in radians, but not in degrees."""
    angles = [angle for each in evidence.received for angle in _angles(each.message)]
    sizes = [abs(angle) for angle in angles if math.isfinite(angle)]
    if not sizes or not math.tau < max(sizes) <= TURN_DEG:
        return
    shown = max(angles, key=lambda angle: abs(angle) if math.isfinite(angle) else 0.0)
    yield Finding(
        title='degrees instead of radians',
        expected='angles in radians in message.position (a full turn is 6.283)',
        seen=f'{shown:.1f}, which looks like degrees:'
        f' as radians it is {abs(shown) / math.tau:.1f} turns',
        fix='convert before you publish',
        code='message.position = [math.radians(angle) for angle in message.position]',
        broken=evidence.publishers,
    )


def _angles(message: Any) -> list[float]:
    """Return the positions of a JointState's joints, without continuous ones."""
    if type(message).__name__ != 'JointState':
        return []
    return [
        angle
        for name, angle in zip(message.name, message.position, strict=False)
        if not any(word in name.lower() for word in _TURNS_FOREVER)
    ]
