"""What a participant has looked at long enough: the checks of a grade cell share one.

An endpoint that comes a moment later than the first is waited for once. After that it is there, or
it was made between two checks.
"""

from collections.abc import Hashable
from weakref import WeakKeyDictionary

from rclpy.context import Context

_seen: WeakKeyDictionary[Context, dict[Hashable, object]] = WeakKeyDictionary()


def is_known(context: Context, name: Hashable, what: object) -> bool:
    """Whether this, and nothing else, was there the last time that somebody waited."""
    return _seen.get(context, {}).get(name) == what


def remember(context: Context, name: Hashable, what: object) -> None:
    """This has been there for a moment, and nothing else has come."""
    _seen.setdefault(context, {})[name] = what
