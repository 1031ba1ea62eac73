"""Values that are sent between the test kernel and the student's kernel, encoded as JSON.

A value is plain JSON (null, true, 1, 1.5, "text", a list), or an object with one tag:
{"float": "nan"}, {"tuple": […]}, {"set": […]}, {"dict": [[key, value], …]}, or a ROS message
{"ros": "sensor_msgs/msg/JointState", "cdr": base64}. NumPy scalars and arrays are sent as plain
numbers and lists, list-like objects as lists, mappings as dicts. Messages are decoded only from
MESSAGE_PACKAGES; no other module is imported.
"""

import base64
import contextlib
import importlib
import math
import os
import re
from collections import UserList, deque
from collections.abc import Iterator, KeysView, Mapping, ValuesView
from typing import Any

import numpy as np

from my_robot_basics.exchange.wrong_fields import wrong_field

MOST_DEPTH = 32
MESSAGE_PACKAGES = (
    'builtin_interfaces',
    'diagnostic_msgs',
    'geometry_msgs',
    'nav_msgs',
    'sensor_msgs',
    'shape_msgs',
    'std_msgs',
    'stereo_msgs',
    'trajectory_msgs',
    'visualization_msgs',
)

WRONG_FIELD = 'a field of a wrong type'
"""What the text of UnsupportedValue says about a message that cannot be serialized."""

_MESSAGE_NAME = re.compile(rf'({"|".join(MESSAGE_PACKAGES)})/msg/([A-Z][A-Za-z0-9]*)')
_LISTS = list, UserList, deque, ValuesView
"""Types that are sent as a list; `names = !ros2 …` gives a list of IPython's own class."""
_SPECIAL_FLOATS = {'nan': math.nan, 'inf': math.inf, '-inf': -math.inf}


class WireError(ValueError):
    """A text that does not follow this protocol."""


class UnsupportedValue(TypeError):
    """A value that cannot be transmitted; the exception's text describes its type."""


def encode(value: object, depth: int = 0) -> Any:
    """Encode a plain value as JSON data. Raises UnsupportedValue."""
    if depth > MOST_DEPTH:
        raise UnsupportedValue(f'values nested more than {MOST_DEPTH} deep')
    if isinstance(value, np.generic | np.ndarray):
        if value.dtype.kind not in 'biufU':
            raise UnsupportedValue(
                f'a numpy {value.dtype} in it' if depth else f'a numpy {value.dtype}'
            )
        value = value.tolist()
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else {'float': repr(float(value))}
    if isinstance(value, _LISTS):
        return [encode(item, depth + 1) for item in value]
    if isinstance(value, tuple):
        return {'tuple': [encode(item, depth + 1) for item in value]}
    if isinstance(value, set | frozenset | KeysView):
        return {'set': [encode(item, depth + 1) for item in value]}
    if isinstance(value, Mapping):
        pairs = value.items()
        return {'dict': [[encode(k, depth + 1), encode(v, depth + 1)] for k, v in pairs]}
    return _encode_message(value, depth)


def decode(encoded: object, depth: int = 0) -> Any:
    """Turn encoded JSON back into a value. Raises WireError, and nothing else."""
    if depth > MOST_DEPTH:
        raise WireError(f'values nested more than {MOST_DEPTH} deep')
    if encoded is None or isinstance(encoded, bool | int | float | str):
        return encoded
    if isinstance(encoded, list):
        return [decode(item, depth + 1) for item in encoded]
    match encoded:
        case {'float': str(name), **rest} if name in _SPECIAL_FLOATS and not rest:
            return _SPECIAL_FLOATS[name]
        case {'tuple': list(items), **rest} if not rest:
            return tuple(decode(item, depth + 1) for item in items)
        case {'set': list(items), **rest} if not rest:
            return {_hashable(decode(item, depth + 1)) for item in items}
        case {'dict': list(pairs), **rest} if not rest:
            if not all(isinstance(pair, list) and len(pair) == 2 for pair in pairs):
                raise WireError('a dict that is not a list of pairs')
            return {_hashable(decode(k, depth + 1)): decode(v, depth + 1) for k, v in pairs}
        case {'ros': str(name), 'cdr': str(cdr), **rest} if not rest:
            return _decode_message(name, cdr)
    raise WireError('an object with an unknown tag')


def message_type(name: str) -> type:
    """Return the class of an allowed name like 'std_msgs/msg/String', or raise WireError."""
    parts = _MESSAGE_NAME.fullmatch(name)
    found = parts and getattr(importlib.import_module(f'{parts[1]}.msg'), parts[2], None)
    if not found:
        raise WireError('a message type that is not allowed')
    return found


def type_name(type_: type) -> str:
    """Return an interface's full name: 'std_msgs/msg/String', 'arm_interfaces/action/MoveArm'."""
    return '/'.join([*type_.__module__.split('.')[:2], type_.__name__])


def _encode_message(value: Any, depth: int) -> dict:
    type_ = next(filter(_is_known, type(value).__mro__), None)
    if type_ is None:
        own_name = type(value).__name__
        raise UnsupportedValue(f'{own_name} in it' if depth else own_name)
    name = type_name(type_)
    for field in value.get_fields_and_field_types():
        if isinstance(getattr(value, field), set | frozenset):
            raise UnsupportedValue(f'{name} with {WRONG_FIELD} ({field} is a set: no order)')
    from rclpy.serialization import serialize_message

    try:
        cdr = serialize_message(value)
    except Exception as error:
        # rclpy passes on what the conversion of a field raises: TypeError, AttributeError, …
        path, held, wanted = wrong_field(value, type_)
        what = f'{path} = {held} is no {wanted}' if path else error
        raise UnsupportedValue(f'{name} with {WRONG_FIELD} ({what})') from error
    return {'ros': name, 'cdr': base64.b64encode(cdr).decode('ascii')}


def _is_known(type_: type) -> bool:
    """Whether this is an allowed message class; a subclass of one is sent as its base."""
    try:
        return message_type(type_name(type_)) is type_
    except WireError:
        return False


def _decode_message(name: str, cdr: str) -> object:
    wanted = message_type(name)
    from rclpy.serialization import deserialize_message

    try:
        data = base64.b64decode(cdr, validate=True)
        with _quiet_c_stderr():
            return deserialize_message(data, wanted)
    except Exception as error:
        # The bytes come from a student: whatever the C library raises, the bytes are invalid.
        raise WireError(f'bytes that are not a {name}') from error


@contextlib.contextmanager
def _quiet_c_stderr() -> Iterator[None]:
    """Silence descriptor 2: Fast CDR prints its error there before it raises."""
    saved, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(nowhere)


def _hashable(value: object) -> object:
    try:
        hash(value)
    except TypeError as error:
        raise WireError('a set member or dict key that cannot be one') from error
    return value
