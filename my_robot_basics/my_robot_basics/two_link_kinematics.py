"""Forward and inverse kinematics of a planar arm with two links: pure maths, no ROS.

The base is at the origin of `base_link`. θ1 is the angle from the x axis to the first link and
θ2 the angle from the first link to the second one, both counter-clockwise. Angles are in degrees
and lengths in metres; messages carry radians, so nodes convert when they publish or receive.
"""

import numpy as np
from numpy.typing import ArrayLike

L1 = 1.0  # m, first link of the course's arm
L2 = 0.8  # m, second link

BORDER_M = 1e-9  # a target at most this far outside the reachable ring counts as on its border


def forward_kinematics(
    theta1_deg: ArrayLike, theta2_deg: ArrayLike, l1: ArrayLike = L1, l2: ArrayLike = L2
) -> tuple:
    """Return the end effector's position, (x, y) in metres, for joint angles in degrees.

    Numbers give two floats; arrays are broadcast against each other and give two arrays.
    Raises ValueError for NaN, infinity, or a link length that is not positive.
    """
    theta1_deg, theta2_deg = _finite(theta1_deg=theta1_deg, theta2_deg=theta2_deg)
    l1, l2 = _lengths(l1=l1, l2=l2)
    first = np.radians(theta1_deg)
    second = first + np.radians(theta2_deg)  # θ2 is relative to the first link, not to the x axis
    x = l1 * np.cos(first) + l2 * np.cos(second)
    y = l1 * np.sin(first) + l2 * np.sin(second)
    return _plain(x), _plain(y)


def inverse_kinematics(
    x: ArrayLike, y: ArrayLike, l1: ArrayLike = L1, l2: ArrayLike = L2
) -> dict[str, tuple]:
    """Return both poses that reach (x, y): {'elbow_up': (θ1, θ2), 'elbow_down': (θ1, θ2)}.

    Look from the base towards the target. In the pose `elbow_up` the elbow is on the left of that
    line (above it, for a target on the positive x axis) and θ2 <= 0; in `elbow_down` it is on the
    right and θ2 >= 0. All angles are in degrees, above -180 and up to 180, so an arm that is
    folded back has θ2 = 180 in both. If the arm is stretched or folded, the two poses are equal.

    Targets are in metres. Numbers give floats; arrays are broadcast against each other and give
    arrays. A target that is at most 1e-9 m outside the reachable ring counts as on its border.
    Only links of equal length reach the base itself: any θ1 is right there, and both poses have
    θ1 = 0.

    Raises ValueError for a target out of reach (with arrays, for any such target), and for NaN,
    infinity, or a link length that is not positive.
    """
    x, y = _finite(x=x, y=y)
    l1, l2 = _lengths(l1=l1, l2=l2)
    distance = np.hypot(x, y)
    nearest, farthest = np.abs(l1 - l2), l1 + l2
    _refuse_unreachable(distance, nearest, farthest)

    # The triangle base-elbow-target by the law of cosines, written with half angles: arccos would
    # lose half of its digits when the arm is nearly stretched or folded.
    r = np.clip(distance, nearest, farthest)
    bend = 2 * np.arctan2(
        np.sqrt((farthest - r) * (farthest + r)), np.sqrt((r - nearest) * (r + nearest))
    )  # between the extension of the first link and the second link
    offset = 2 * np.arctan2(
        np.sqrt((farthest - r) * (r - (l1 - l2))), np.sqrt((farthest + r) * (r + (l1 - l2)))
    )  # between the line to the target and the first link
    bearing = np.arctan2(y, x)
    return {
        'elbow_up': (_wrapped_deg(bearing + offset), _wrapped_deg(-bend)),
        'elbow_down': (_wrapped_deg(bearing - offset), _wrapped_deg(bend)),
    }


def _finite(**values: ArrayLike) -> list[np.ndarray]:
    arrays = []
    for name, value in values.items():
        array = np.asarray(value, dtype=float)
        if not np.isfinite(array).all():
            seen = str(value)
            raise ValueError(f'{name} must be finite, got {seen}: check for NaN and infinity')
        arrays.append(array)
    return arrays


def _lengths(**values: ArrayLike) -> list[np.ndarray]:
    arrays = _finite(**values)
    for name, array in zip(values, arrays, strict=True):
        if not (array > 0).all():
            seen = str(values[name])
            raise ValueError(f'{name} must be a length above 0 m, got {seen}')
    return arrays


def _refuse_unreachable(distance: np.ndarray, nearest: np.ndarray, farthest: np.ndarray) -> None:
    distance, nearest, farthest = np.broadcast_arrays(distance, nearest, farthest)
    too_far = distance > farthest + BORDER_M
    bad = too_far | (distance < nearest - BORDER_M)
    if not bad.any():
        return
    first = np.flatnonzero(bad)[0]  # a single number is an array of one element here
    is_far = too_far.flat[first]
    target = (
        f'the target is {distance.flat[first]:.6g} m from the base'
        if bad.ndim == 0
        else f'{bad.sum()} of {bad.size} targets are out of reach; the first is '
        f'{distance.flat[first]:.6g} m from the base'
    )
    reason = (
        f'too far: the arm reaches {farthest.flat[first]:.6g} m (l1 + l2)'
        if is_far
        else f'too near: the arm cannot come closer than {nearest.flat[first]:.6g} m (|l1 - l2|)'
    )
    raise ValueError(
        f'{target}, {reason}. Choose a {"nearer" if is_far else "farther"} target '
        'or other link lengths'
    )


def _wrapped_deg(angle_rad: np.ndarray) -> float | np.ndarray:
    """Convert radians to degrees in the range -180 (excluded) to 180 (included)."""
    angle = np.degrees(angle_rad)
    angle = np.where(angle > 180, angle - 360, angle)
    angle = np.where(angle <= -180, angle + 360, angle)
    return _plain(angle + 0.0)  # turns -0.0 into 0.0


def _plain(value: np.ndarray) -> float | np.ndarray:
    return float(value) if np.ndim(value) == 0 else value
