"""Messages that a node may treat unlike others: equal ones, zeros, negative and large numbers."""

import array
import copy
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

PLAIN, AGAIN = '', 'equal to the one before'
ZERO, NEGATIVE, LARGE = 'with zeros, or empty', 'with negative numbers', 'with large numbers'
BLOCK = (PLAIN, PLAIN, AGAIN, ZERO, NEGATIVE, LARGE)
"""What each so many messages are, in an order that differs each time: a node that counts messages
meets every kind."""
LARGE_FACTOR = 100.0
SHUFFLED = 2026
FRAME_ID = 'base_link'


@dataclass(frozen=True)
class Sent:
    """A message, and what is special about it, in words that tell no number."""

    message: Any
    kind: str


def varied(make_message: Callable[[], Any]) -> Iterator[Sent]:
    """Yield messages without end, made of those of `make_message`, of every kind."""
    order = random.Random(SHUFFLED)
    while True:
        for kind in order.sample(BLOCK, len(BLOCK)):
            if kind == AGAIN:
                message = make_message()
                yield Sent(message, PLAIN)
                yield Sent(message, AGAIN)
            else:
                yield Sent(changed(make_message(), kind), kind)


def filled(make_message: Callable[[], Any]) -> Callable[[], Any]:
    """Make its messages with a stamp, a frame, velocities and efforts where these are empty.

    Each stamp is another one, and older than now: a copy has it, and a new one does not.
    """
    numbers = random.Random(SHUFFLED)

    def make_filled() -> Any:
        message = make_message()
        if hasattr(message, 'header'):
            message.header.frame_id = message.header.frame_id or FRAME_ID
            message.header.stamp.sec = numbers.randrange(1, 1_000_000_000)
            message.header.stamp.nanosec = numbers.randrange(1_000_000_000)
        for field in ('velocity', 'effort'):
            if hasattr(message, field) and not getattr(message, field):
                setattr(message, field, [numbers.random() for _ in message.position])
        return message

    return make_filled


def changed(message: Any, kind: str) -> Any:
    """A copy with its numbers changed; a text is left out where numbers are to be zeros."""
    message = copy.deepcopy(message)
    for field in message.get_fields_and_field_types():
        value = getattr(message, field)
        if isinstance(value, array.array) and value.typecode in 'df':
            setattr(message, field, [_number(each, kind) for each in value])
        elif isinstance(value, str) and kind == ZERO:
            setattr(message, field, '')
    return message


def _number(value: float, kind: str) -> float:
    return {ZERO: 0.0, NEGATIVE: -abs(value), LARGE: LARGE_FACTOR * value}.get(kind, value)
