"""How often feedback of `/move_arm` comes, and for how long it says the same; times in s."""

import numpy as np

from my_robot_basics.checks.recordings import periods


def rate_hz(times: np.ndarray, *, is_driven: bool) -> float:
    """The rate from the first message to the last; on the wall clock, without delays."""
    if not is_driven:
        return 1.0 / max(periods.intended_period(times), 1e-9)
    return (len(times) - 1) / max(float(np.ptp(times)), 1e-9)


def longest_same_sec(times: np.ndarray, positions: np.ndarray) -> float:
    """For how long one of the positions, a row each, was told before another one was."""
    is_new = np.array([True, *np.any(np.diff(positions, axis=0) != 0.0, axis=1)])
    return float(np.diff(times[is_new]).max(initial=0.0))
