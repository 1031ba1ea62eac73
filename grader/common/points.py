"""Points as people read them: without what binary fractions leave behind."""

from collections.abc import Iterable


def in_hundredths(points: float) -> float:
    """Return points that were worked out: 0.3 where 3 * 0.1 is 0.30000000000000004."""
    return round(points, 2)


def added_up(points: Iterable[float]) -> float:
    """Return a sum: 0.9 where 0.7 + 0.1 + 0.1 is 0.8999999999999999.

    What a person gave in finer steps than hundredths stays.
    """
    return round(sum(points), 6)
