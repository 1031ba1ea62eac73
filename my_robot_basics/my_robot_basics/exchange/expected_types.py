"""Compare an answer's type with the expected one, and describe the difference."""

import re

from my_robot_basics.exchange import values
from my_robot_basics.feedback.errors import fail, shorten
from my_robot_basics.feedback.hidden import student_text

_CLASS_OF_A_MESSAGE = 'Metaclass_'
"""rosidl's metaclass of a message class is called this, plus the name of that class."""
_ITERATOR = re.compile(r' = <\w+ object ')
"""In the text about a field of a wrong type: it holds a generator, a map, a zip, …"""


def check_type(
    found: object, wanted: type | tuple[type, ...] | None, *, what: str, cause: str
) -> None:
    """Fail unless `found` has that type; a bool is not an int, an int is accepted as a float."""
    if wanted is None:
        return
    types = wanted if isinstance(wanted, tuple) else (wanted,)
    if type(found) in types or (type(found) is int and float in types):
        return
    seen = f'{with_article(type(found).__name__)} ({brief(found)})'
    hint = _other_type(found, types)
    fail(expected=f'{what} {wanted_type(wanted)}', seen=seen, hint=hint, cause=cause)


def what_is_unsupported(body: str, wanted: type | tuple[type, ...] | None) -> tuple[str, str]:
    """Return what a result that cannot be transmitted is, and a hint; `body` names its type."""
    if values.WRONG_FIELD in body and _ITERATOR.search(body):
        hint = 'write list(…) around it: a generator, map or zip is no list'
    elif values.WRONG_FIELD in body:
        hint = 'give each field a value of the type that get_fields_and_field_types() names'
    elif body.startswith(_CLASS_OF_A_MESSAGE):
        # any class may be called so, also after an input that is hidden
        name = student_text(shorten(body.removeprefix(_CLASS_OF_A_MESSAGE), 60))
        return f'the class {name}', f'make a message of it with parentheses, {name}()'
    elif isinstance(wanted, type) and body == wanted.__name__:
        return f'another class {body}', f'make no class {body} of your own: import that of ROS'
    elif isinstance(wanted, type) and hasattr(wanted, 'get_fields_and_field_types'):
        hint = _other_type(None, (wanted,))
    else:
        hint = 'return plain values (numbers, text, lists, dicts) or a ROS message'
    return kind_of(body), hint


def kind_of(body: str) -> str:
    """Describe a value that cannot be transmitted; `body` names its type, `type` for a class."""
    if body.startswith(('a numpy ', 'values ')):  # already a description
        return shorten(body)
    return 'a class' if body == 'type' else with_article(shorten(body))


def _other_type(found: object, wanted: tuple[type, ...]) -> str:
    if isinstance(found, str) and str not in wanted:
        return 'a text in quotes is always a text, even if it looks like another value'
    if dict in wanted:
        return 'write a dict, {key: value, …}, with the keys of the answer cell'
    if bool in wanted:
        return 'write True or False, or a comparison, which makes one of them'
    if any(hasattr(each, 'get_fields_and_field_types') for each in wanted):
        return f'make a message with {wanted[0].__name__}(), fill in its fields, and return it'
    return 'print(type(…)) of the value shows what it is'


def cause_of_wrong_type(name: str, returns: type | tuple[type, ...] | None) -> str:
    """Return the cause of a failure, without the returned value."""
    return f'`{name}` does not always return {wanted_type(returns)}'


def wanted_type(types: type | tuple[type, ...] | None) -> str:
    """Return the accepted types in words: 'a float or an int'."""
    if types is None:
        return 'a plain value or a ROS message'
    types = types if isinstance(types, tuple) else (types,)
    return ' or '.join(with_article(each.__name__) for each in types)


def with_article(noun: str) -> str:
    """Return a noun with its article, a or an."""
    return f'{"an" if noun[:1].lower() in "aeiou" else "a"} {noun}'


def brief(argument: object) -> str:
    """Return an argument as a student would type it; for a message, its type alone."""
    if hasattr(argument, 'get_fields_and_field_types'):
        return f'{type(argument).__name__}(…)'
    return shorten(repr(argument), 60)
