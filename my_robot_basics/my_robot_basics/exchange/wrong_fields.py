"""Find the field of a ROS message whose value does not have the field's type."""

import re
from reprlib import Repr
from typing import Any

_ADDRESS = re.compile(r' at 0x[0-9a-f]+')
_FIELDS = 'get_fields_and_field_types'
_NONE = '', '', ''
_BRIEF = Repr()
_BRIEF.fillvalue = '…'
_BRIEF.maxstring = _BRIEF.maxother = 60


def wrong_field(message: Any, type_: type) -> tuple[str, str, str]:
    """Return a field, its value and its type: ('header.frame_id', '5', 'string'); else three ''.

    It is the first field that cannot be serialized in a message whose other fields are defaults.
    """
    for field, wanted in message.get_fields_and_field_types().items():
        value = getattr(message, field)
        if _can_serialize(type_(), field, value):
            continue
        if type(value) is type(getattr(type_(), field)) and _is_message(value):
            inner, held, type_name = wrong_field(value, type(value))
            if inner:
                return f'{field}.{inner}', held, type_name
        for number, each in enumerate(value if isinstance(value, list) else ()):
            inner, held, type_name = wrong_field(each, type(each)) if _is_message(each) else _NONE
            if inner:
                return f'{field}[{number}].{inner}', held, type_name
        return field, _ADDRESS.sub('', _BRIEF.repr(value)), wanted
    return _NONE


def _is_message(value: object) -> bool:
    return hasattr(value, _FIELDS)


def _can_serialize(message: object, field: str, value: object) -> bool:
    from rclpy.serialization import serialize_message

    try:
        setattr(message, field, value)
        serialize_message(message)
    except Exception:
        return False
    return True
