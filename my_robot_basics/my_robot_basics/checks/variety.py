"""Messages that a node may treat unlike others: with zeros, say, or without velocities."""

import array
import copy
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

PLAIN, AGAIN = '', 'equal to the one before'
ZERO, NEGATIVE, LARGE = 'with zeros, or empty', 'with negative numbers', 'with large numbers'
BARE = 'without velocities and efforts'
"""As the arm of the lessons sends them: a node that zips all four lists makes nothing of them."""
UNSTAMPED = 'without a stamp and a frame'
"""As a node sends them that forgets both: lesson 7 has one."""
BLOCK = (PLAIN, BARE, UNSTAMPED, AGAIN, ZERO, NEGATIVE, LARGE)
"""What each so many messages are, in an order that differs each time: a node that counts messages
meets every kind."""
LARGE_FACTOR = 100.0
SHUFFLED = 2026
UNMEASURED = 'velocity', 'effort'
"""Fields of a JointState that a sensor may leave empty."""


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
                made = make_message()
                message = changed(made, kind)
                yield Sent(message, PLAIN if message == made else kind)


def filled(make_message: Callable[[], Any]) -> Callable[[], Any]:
    """Make its messages with a stamp, a frame, velocities and efforts where these are empty.

    Each stamp is another one, and older than now: a copy has it, and a new one does not. So is
    each frame another one than the usual base_link.
    """
    numbers = random.Random(SHUFFLED)

    def make_filled() -> Any:
        message = make_message()
        if hasattr(message, 'header'):
            message.header.frame_id = message.header.frame_id or _frame_id(numbers)
            message.header.stamp.sec = numbers.randrange(1, 1_000_000_000)
            message.header.stamp.nanosec = numbers.randrange(1_000_000_000)
        for field in UNMEASURED:
            if hasattr(message, field) and not getattr(message, field):
                setattr(message, field, [numbers.random() for _ in message.position])
        return message

    return make_filled


def changed(message: Any, kind: str) -> Any:
    """A copy with its numbers changed; a text is left out where numbers are to be zeros.

    What is BARE has only the numbers that every sensor sends, what is UNSTAMPED no header.
    """
    message = copy.deepcopy(message)
    if kind == UNSTAMPED and hasattr(message, 'header'):
        message.header = type(message.header)()
    for field in message.get_fields_and_field_types():
        value = getattr(message, field)
        if field in UNMEASURED and kind == BARE:
            setattr(message, field, [])
        elif isinstance(value, array.array) and value.typecode in 'df':
            setattr(message, field, [_number(each, kind) for each in value])
        elif isinstance(value, str) and kind == ZERO:
            setattr(message, field, '')
    return message


def _frame_id(numbers: random.Random) -> str:
    return f'sensor{numbers.randrange(1, 100)}_link'


def _number(value: float, kind: str) -> float:
    return {ZERO: 0.0, NEGATIVE: -abs(value), LARGE: LARGE_FACTOR * value}.get(kind, value)
