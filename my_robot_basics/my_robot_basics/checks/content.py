"""The content of a message as a value that is equal, and has an equal hash, for equal messages."""

import array
from collections.abc import Hashable
from typing import Any

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message


def content(message: Any) -> Hashable:
    """Everything that a message holds once it is received: a float32 is rounded then.

    The serialized bytes would not do: Fast CDR leaves the bytes between fields as they were in
    memory, such as those before an empty sequence of doubles, and these differ from time to time.
    """
    return _hashable(deserialize_message(serialize_message(message), type(message)))


def _hashable(value: Any) -> Hashable:
    if hasattr(value, 'get_fields_and_field_types'):
        return tuple(
            _hashable(getattr(value, name)) for name in value.get_fields_and_field_types()
        )
    if isinstance(value, array.array | np.ndarray):
        return value.tobytes()
    if isinstance(value, list):
        return tuple(map(_hashable, value))
    # nan is not equal to nan, and 0.0 is equal to -0.0; their texts are what is wanted here
    return value.hex() if isinstance(value, float) else value
