"""A variable of the environment that is another one for a moment."""

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def set_meanwhile(name: str, value: str) -> Iterator[None]:
    """Set a variable of this process; give it back as it was, or was not, whatever happens."""
    former = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if former is None:
            del os.environ[name]
        else:
            os.environ[name] = former
