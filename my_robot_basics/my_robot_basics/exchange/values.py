"""Values that cross between the test kernel and the student's kernel, as what JSON can hold.

A value is JSON as it stands (null, true, 1, 1.5, "text", a list), or an object with one tag:
{"float": "nan"}, {"tuple": […]}, {"set": […]}, {"dict": [[key, value], …]}, or a ROS message
{"ros": "sensor_msgs/msg/JointState", "cdr": base64}. NumPy scalars and arrays travel as the
plain numbers and lists that they hold, and what is like a list or a dict as one. Nothing outside
MESSAGE_PACKAGES is ever imported.
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
"""What is unsupported about a message that does not travel."""

_MESSAGE_NAME = re.compile(rf'({"|".join(MESSAGE_PACKAGES)})/msg/([A-Z][A-Za-z0-9]*)')
_LISTS = list, UserList, deque, ValuesView
"""What travels as a list; `names = !ros2 …` makes one of a class of IPython's own."""
_SPECIAL_FLOATS = {'nan': math.nan, 'inf': math.inf, '-inf': -math.inf}


class WireError(ValueError):
    """A text that is not of this protocol."""


class UnsupportedValue(TypeError):
    """A value that does not travel; the message is its type, in words."""


def encode(value: object, depth: int = 0) -> Any:
    """Turn a plain value into what JSON can hold. Raises UnsupportedValue."""
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
    """The class of an allow-listed message name like 'std_msgs/msg/String'. Raises WireError."""
    parts = _MESSAGE_NAME.fullmatch(name)
    found = parts and getattr(importlib.import_module(f'{parts[1]}.msg'), parts[2], None)
    if not found:
        raise WireError('a message type that is not allowed')
    return found


def type_name(type_: type) -> str:
    """The name of an interface's class: 'std_msgs/msg/String', 'arm_interfaces/action/MoveArm'."""
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
        # rclpy raises whatever the field's conversion raised: TypeError, AttributeError, …
        path, held, wanted = wrong_field(value, type_)
        what = f'{path} = {held} is no {wanted}' if path else error
        raise UnsupportedValue(f'{name} with {WRONG_FIELD} ({what})') from error
    return {'ros': name, 'cdr': base64.b64encode(cdr).decode('ascii')}


def _is_known(type_: type) -> bool:
    """Whether a class is that of a message which travels; one derived from it travels as it."""
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
        # The bytes come from a student: whatever the C library says of them, they are wrong.
        raise WireError(f'bytes that are not a {name}') from error


@contextlib.contextmanager
def _quiet_c_stderr() -> Iterator[None]:
    """Fast CDR prints its complaint to descriptor 2 before it raises; a check prints nothing."""
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
