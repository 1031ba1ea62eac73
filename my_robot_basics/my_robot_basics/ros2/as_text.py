"""Format messages as YAML and as comma-separated values, as `ros2 topic echo` does."""

import array
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy
import yaml
from rosidl_parser import definition

_SEQUENCES = (list, tuple, array.array, numpy.ndarray)


@dataclass(frozen=True)
class Shortening:
    """How to shorten a message."""

    length: int | None = None
    """Array elements and string characters beyond this number are replaced by `...`."""
    no_arr: bool = False
    """Show the type and length of an array instead of its elements."""
    no_str: bool = False
    """Show the length of a string instead of the string."""


class _Dumper(yaml.SafeDumper):
    """A dumper whose flow style puts only arrays on one line, as in ros2cli."""


def _represent_fields(dumper: yaml.SafeDumper, fields: dict[str, Any]) -> yaml.MappingNode:
    pairs = [(dumper.represent_data(n), dumper.represent_data(v)) for n, v in fields.items()]
    return yaml.MappingNode('tag:yaml.org,2002:map', pairs, flow_style=False)


_Dumper.add_representer(dict, _represent_fields)


def as_yaml(message: Any, shortening: Shortening, *, flow_style: bool = False) -> str:
    """Return a message as a YAML document."""
    return yaml.dump(
        _plain_message(message, shortening),
        Dumper=_Dumper,
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=flow_style,
    )


def as_csv(message: Any, shortening: Shortening) -> str:
    """Return all values of a message and its nested messages on one line."""
    return _joined(
        _cell(getattr(message, name), slot_type, shortening)
        for name, slot_type in _fields(message)
    )


def _fields(message: Any) -> zip:
    return zip(message.get_fields_and_field_types(), message.SLOT_TYPES, strict=True)


def _plain_message(message: Any, shortening: Shortening) -> dict[str, Any]:
    return {
        name: _plain(getattr(message, name), slot_type, shortening)
        for name, slot_type in _fields(message)
    }


def _plain(value: Any, slot_type: Any, shortening: Shortening) -> Any:
    length = shortening.length
    if isinstance(value, bytes):
        return _cut(value.decode('latin-1'), length)
    if isinstance(value, str):
        return _length_of(value) if shortening.no_str else _cut(value, length)
    if isinstance(value, _SEQUENCES):
        if shortening.no_arr and slot_type is not None:
            return _kind_of(value, slot_type)
        items = [_plain(item, None, shortening) for item in value[:length]]
        return items if len(items) == len(value) else [*items, '...']
    if isinstance(value, numpy.generic):
        return value.item()
    if isinstance(value, bool | int | float):
        return value
    return _plain_message(value, shortening)


def _cell(value: Any, slot_type: Any, shortening: Shortening) -> str:
    length = shortening.length
    if isinstance(value, _SEQUENCES):
        if shortening.no_arr and slot_type is not None:
            return _kind_of(value, slot_type)
        cells = [_cell(item, None, shortening) for item in value[:length]]
        return _joined(cells if len(cells) == len(value) else [*cells, '...'])
    if isinstance(value, str):
        return _length_of(value) if shortening.no_str else _cut(value, length)
    if isinstance(value, bytes):
        return str(value if length is None or len(value) <= length else value[:length] + b'...')
    if isinstance(value, bool | int | float | numpy.generic):
        return str(value)
    return as_csv(value, shortening)


def _joined(cells: Iterable[str]) -> str:
    """Join cells as ros2cli does: no comma follows empty cells at the start."""
    line = ''
    for cell in cells:
        line = f'{line},{cell}' if line else cell
    return line


def _cut(text: str, length: int | None) -> str:
    return text if length is None or len(text) <= length else text[:length] + '...'


def _length_of(text: str) -> str:
    return f'<string length: <{len(text)}>>'


def _kind_of(value: Any, slot_type: Any) -> str:
    name = type_name(slot_type.value_type)
    if isinstance(slot_type, definition.Array):
        return f'<array type: {name}[{slot_type.size}]>'
    bound = getattr(slot_type, 'maximum_size', None)
    size = '' if bound is None else f'[{bound}]'
    return f'<sequence type: {name}{size}, length: {len(value)}>'


def type_name(slot_type: Any) -> str:
    """Return a field type's name, such as `double`, `string` or `geometry_msgs/msg/Point`."""
    if isinstance(slot_type, definition.BasicType):
        return slot_type.typename
    if isinstance(slot_type, definition.NamespacedType):
        return '/'.join(slot_type.namespaced_name())
    return 'wstring' if isinstance(slot_type, definition.AbstractWString) else 'string'
