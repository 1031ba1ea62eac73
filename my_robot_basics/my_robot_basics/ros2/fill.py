"""Fill the fields of a message with values that a user has typed.

Each value is checked against the field's type: rclpy does not check it, and some crash it.
"""

import difflib
import math
from collections.abc import Callable
from functools import partial
from typing import Any

from rosidl_parser import definition

from my_robot_basics.ros2.as_text import type_name
from my_robot_basics.ros2.interfaces import message_class

_MOST_FLOAT32 = 3.4028235677973366e38  # smaller numbers are rounded to a finite float32
_TIME = 'builtin_interfaces/msg/Time'
_HEADER = 'std_msgs/msg/Header'

StampSetter = Callable[[Any], None]


class BadValue(ValueError):
    """A value that does not fit its field; the text names the field's path and its type."""


def fill(message: Any, values: dict) -> None:
    """Set fields of a message from a dictionary; raises BadValue."""
    _fill(message, values, '', None)


def fill_to_publish(message: Any, values: dict) -> list[StampSetter]:
    """Set fields of a message from a dictionary, and return setters for its time stamps.

    As in ros2cli, `auto` for a header and `now` for a time mean the time of publication: each
    setter in the list takes that as a builtin_interfaces Time. Raises BadValue.
    """
    setters: list[StampSetter] = []
    _fill(message, values, '', setters)
    return setters


def _fill(message: Any, values: dict, path: str, setters: list[StampSetter] | None) -> None:
    slot_types = dict(zip(message.get_fields_and_field_types(), message.SLOT_TYPES, strict=True))
    for name, value in values.items():
        if name not in slot_types:
            raise BadValue(_no_such_field(message, name, slot_types, path))
        slot_type, here = slot_types[name], f'{path}{name}'
        if setters is not None and value == 'now' and _is(slot_type, _TIME):
            setters.append(partial(setattr, message, name))
        elif setters is not None and value == 'auto' and _is(slot_type, _HEADER):
            header = getattr(message, name)
            setters.append(partial(setattr, header, 'stamp'))
        else:
            setattr(message, name, _converted(value, slot_type, here, setters))


def _converted(value: Any, slot_type: Any, path: str, setters: list[StampSetter] | None) -> Any:
    if isinstance(slot_type, definition.AbstractNestedType):
        return _list(value, slot_type, path, setters)
    if isinstance(slot_type, definition.NamespacedType):
        name = type_name(slot_type)
        if not isinstance(value, dict):
            raise BadValue(f'{path}: wants the fields of {name} as a dictionary, got {value!r}')
        message = message_class(name)()
        _fill(message, value, f'{path}.', setters)
        return message
    if isinstance(slot_type, definition.AbstractGenericString):
        return _string(value, slot_type, path)
    return _number(value, slot_type.typename, path)


def _list(value: Any, slot_type: Any, path: str, setters: list[StampSetter] | None) -> list:
    wanted = f'a list of {type_name(slot_type.value_type)}'
    if not isinstance(value, list):
        raise BadValue(f'{path}: wants {wanted}, got {value!r}')
    if isinstance(slot_type, definition.Array) and len(value) != slot_type.size:
        raise BadValue(f'{path}: wants {wanted} of length {slot_type.size}, got {len(value)}')
    most = getattr(slot_type, 'maximum_size', math.inf)
    if len(value) > most:
        raise BadValue(f'{path}: wants {wanted} of length {most} at most, got {len(value)}')
    items = enumerate(value)
    filled = [_converted(v, slot_type.value_type, f'{path}[{i}]', setters) for i, v in items]
    return _packed(filled, slot_type)


def _packed(items: list, slot_type: Any) -> Any:
    """Convert a list to the container that message classes use, to get the usual repr."""
    import array

    import numpy

    numpy_type = {'float': 'float32', 'double': 'float64'}
    codes = {
        **{'float': 'f', 'double': 'd'},
        **{'int8': 'b', 'int16': 'h', 'int32': 'i', 'int64': 'q'},
        **{'uint8': 'B', 'uint16': 'H', 'uint32': 'I', 'uint64': 'Q'},
    }
    name = getattr(slot_type.value_type, 'typename', None)
    if name not in codes:
        return items
    if isinstance(slot_type, definition.Array):
        return numpy.array(items, dtype=numpy_type.get(name, name))
    return array.array(codes[name], items)


def _string(value: Any, slot_type: Any, path: str) -> str:
    if value is None or isinstance(value, dict | list | set | bytes):
        raise BadValue(f'{path}: wants a {type_name(slot_type)}, got {value!r}')
    text = str(value)
    most = getattr(slot_type, 'maximum_size', math.inf)
    if len(text) > most:
        raise BadValue(f'{path}: wants {most} characters at most, got {len(text)}')
    try:
        text.encode()
    except UnicodeEncodeError:
        raise BadValue(f'{path}: is not text in UTF-8: {text!a}') from None
    if '\0' in text:
        raise BadValue(f'{path}: a string holds no zero character, got {text!r}')
    return text


def _number(value: Any, name: str, path: str) -> Any:
    if name == 'boolean':
        if value in (True, False) and isinstance(value, bool | int):
            return bool(value)
        raise BadValue(f'{path}: wants true or false, got {value!r}')
    if name in ('float', 'double', 'long double'):
        return _float(value, name, path)
    return _integer(value, name, path)


def _float(value: Any, name: str, path: str) -> float:
    # text, too: YAML reads 1e3 and 5e-1 as text, and ros2cli accepts a number in quotes
    try:
        number = float(value) if isinstance(value, int | float | str) else None
    except (ValueError, OverflowError):
        number = None
    if number is None or isinstance(value, bool):
        raise BadValue(f'{path}: wants a number ({name}), got {value!r}')
    if name == 'float' and math.isfinite(number) and abs(number) >= _MOST_FLOAT32:
        raise BadValue(f'{path}: {value!r} does not fit a 32-bit {name}')
    return number


def _integer(value: Any, name: str, path: str) -> int | bytes:
    try:
        number = int(value) if isinstance(value, int | str) else None
        if isinstance(value, float) and value.is_integer():
            number = int(value)
    except ValueError:
        number = None
    if number is None or isinstance(value, bool):
        raise BadValue(f'{path}: wants a whole number ({name}), got {value!r}')
    lowest, highest = _range(name)
    if not lowest <= number <= highest:
        raise BadValue(f'{path}: wants {name}, {lowest} to {highest}, got {value!r}')
    return bytes([number]) if name == 'octet' else number


def _range(name: str) -> tuple[int, int]:
    if name in ('octet', 'char', 'uint8'):
        return 0, 255
    bits = int(name.removeprefix('u').removeprefix('int'))
    return (0, 2**bits - 1) if name.startswith('u') else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _is(slot_type: Any, name: str) -> bool:
    return isinstance(slot_type, definition.NamespacedType) and type_name(slot_type) == name


def _no_such_field(message: Any, name: Any, slot_types: dict[str, Any], path: str) -> str:
    own_type = '/'.join([*type(message).__module__.split('.')[:2], type(message).__name__])
    if not slot_types:
        return f'{path}{name}: {own_type} has no fields'
    near = difflib.get_close_matches(str(name), slot_types, n=1)
    hint = f': did you mean {near[0]}?' if near else f', it has {", ".join(slot_types)}'
    return f"{path}{name}: {own_type} has no field '{name}'{hint}"
