"""Round points, so that they are shown without errors of binary fractions."""

from collections.abc import Iterable


def round_points(points: float) -> float:
    """Return computed points rounded: 0.3, not 3 * 0.1 = 0.30000000000000004."""
    return round(points, 2)


def sum_points(points: Iterable[float]) -> float:
    """Return a sum, rounded: 0.7 + 0.1 + 0.1 is 0.9, not 0.8999999999999999.

    Manual scores with more than two decimals keep them.
    """
    return round(sum(points), 6)
