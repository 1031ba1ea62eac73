"""The content of a message as a value that is equal, and has an equal hash, for equal messages."""

import array
from collections.abc import Hashable
from typing import Any

import numpy as np


def content(message: Any) -> Hashable:
    """Everything that a message holds, as a subscription receives it: a float32 is rounded.

    The serialized bytes would not do: Fast CDR leaves the bytes between fields as they were in
    memory, such as those before an empty sequence of doubles, and these differ from time to time.
    """
    types = message.get_fields_and_field_types()
    return tuple(_hashable(getattr(message, name), types[name]) for name in types)


def _hashable(value: Any, type_name: str) -> Hashable:
    if hasattr(value, 'get_fields_and_field_types'):
        return content(value)
    if isinstance(value, array.array | np.ndarray):
        return value.tobytes()
    if isinstance(value, list | tuple):
        return tuple(_hashable(each, '') for each in value)
    if isinstance(value, float):
        # nan is not equal to nan, and 0.0 is equal to -0.0; their texts are what is wanted here
        return (float(np.float32(value)) if type_name == 'float' else value).hex()
    return value
