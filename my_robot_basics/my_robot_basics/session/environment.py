"""Set an environment variable temporarily."""

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def set_meanwhile(name: str, value: str) -> Iterator[None]:
    """Set an environment variable of this process; restore it, or unset it, at the end."""
    former = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if former is None:
            del os.environ[name]
        else:
            os.environ[name] = former
