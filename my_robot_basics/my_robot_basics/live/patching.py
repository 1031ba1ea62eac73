"""Put a function of ours in the place of a class's own."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


def patch(owner: type, name: str, function: Callable[..., Any] | classmethod) -> None:
    """Replace a method for good."""
    setattr(owner, name, function)


@contextmanager
def patched(owner: type, name: str, function: Callable[..., Any] | classmethod) -> Iterator[None]:
    """Replace a method for a while."""
    former = getattr(owner, name)
    patch(owner, name, function)
    try:
        yield
    finally:
        patch(owner, name, former)
