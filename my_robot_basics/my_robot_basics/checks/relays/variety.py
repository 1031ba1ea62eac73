"""Messages that a wrong node may treat unlike others, such as zeros or missing velocities."""

import array
import copy
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

PLAIN, AGAIN = '', 'equal to the one before'
ZERO, NEGATIVE, LARGE = 'with zeros, or empty', 'with negative numbers', 'with large numbers'
BARE = 'without velocities and efforts'
"""The lessons' arm sends such messages; a node that zips all four lists gets nothing from them."""
UNSTAMPED = 'without a stamp and a frame'
"""A node that forgets both sends such messages; lesson 7 has one."""
BLOCK = (PLAIN, BARE, UNSTAMPED, AGAIN, ZERO, NEGATIVE, LARGE)
"""The kinds in each block of messages, in an order that differs from block to block: a node that
leaves out every n-th message meets every kind."""
LARGE_FACTOR = 100.0
SHUFFLED = 2026
UNMEASURED = 'velocity', 'effort'
"""Fields of a JointState that a sensor may leave empty."""


@dataclass(frozen=True)
class VariedMessage:
    """A message, and its kind in words, which reveal none of its numbers."""

    message: Any
    kind: str


def vary_messages(make_message: Callable[[], Any]) -> Iterator[VariedMessage]:
    """Yield endless messages of all kinds, made from those of `make_message`."""
    order = random.Random(SHUFFLED)
    while True:
        for kind in order.sample(BLOCK, len(BLOCK)):
            if kind == AGAIN:
                message = make_message()
                yield VariedMessage(message, PLAIN)
                yield VariedMessage(message, AGAIN)
            else:
                made = make_message()
                message = changed_copy(made, kind)
                yield VariedMessage(message, PLAIN if message == made else kind)


def with_filled_fields(make_message: Callable[[], Any]) -> Callable[[], Any]:
    """A function that fills in stamp, frame, velocities and efforts in `make_message`'s messages.

    Stamps are random and in the past, and frames are not the usual base_link: so a relayed message
    differs from one that the node makes itself.
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


def changed_copy(message: Any, kind: str) -> Any:
    """A copy of the message, changed to that kind.

    ZERO also empties texts, BARE the fields that a sensor may leave empty, UNSTAMPED the header.
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
