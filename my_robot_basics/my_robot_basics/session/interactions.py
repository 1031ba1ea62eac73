"""How often checks have done more with the nodes than listen to them."""

_count = 0


def note() -> None:
    """Something is done that may change what a node does: a message, a call, a parameter."""
    global _count
    _count += 1


def count() -> int:
    """How often so far."""
    return _count
