"""Count how often checks have done more with the nodes than receive their messages."""

_count = 0


def note() -> None:
    """Count an action that may change a node's behaviour: a message, a call, a parameter."""
    global _count
    _count += 1


def count() -> int:
    """Return the number of such actions so far."""
    return _count
