"""Replace methods of a class."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


def patch(owner: type, name: str, function: Callable[..., Any] | classmethod) -> None:
    """Replace a method permanently."""
    setattr(owner, name, function)


@contextmanager
def patched(owner: type, name: str, function: Callable[..., Any] | classmethod) -> Iterator[None]:
    """Replace a method meanwhile, and restore it at the end."""
    former = getattr(owner, name)
    patch(owner, name, function)
    try:
        yield
    finally:
        patch(owner, name, former)
