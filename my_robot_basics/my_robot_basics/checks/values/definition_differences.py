"""How a definition differs from the right one: names first, then types, arrays and values."""

import difflib
from collections.abc import Sequence
from typing import Any

from my_robot_basics.feedback.errors import shorten
from my_robot_basics.ros2.definitions import SECTIONS, DefinedMember, Definition

_SAME = {'char': 'uint8'}
"""In ROS 2, these are two names of one type."""


def wrong_names(found: Definition, wanted: Sequence[Sequence[str]], kind: str) -> list[str]:
    """A clause for each field or constant that is missing, in the wrong part, or not wanted."""
    faults = []
    for part, names, here in zip(SECTIONS[kind], wanted, found.sections, strict=True):
        for name in names:
            if name not in here:
                faults.append(_missing(name, part, found, wanted, kind))
    asked = {name for names in wanted for name in names}
    for part, names, here in zip(SECTIONS[kind], wanted, found.sections, strict=True):
        for name in here:
            if name not in asked:
                faults.append(f'{part} has {shorten(name, 40)}, which the table does not ask for')
            elif name not in names and name in _all(found, but=here):
                faults.append(f'{name} is in {part}, too')
    return faults


def _missing(
    name: str, part: str, found: Definition, wanted: Sequence[Sequence[str]], kind: str
) -> str:
    for other, here in zip(SECTIONS[kind], found.sections, strict=True):
        if name in here:
            return f'{name} is in {other}, and belongs to {part}'
    asked = {each for names in wanted for each in names}
    others = [each for each in _all(found) if each not in asked]
    similar = difflib.get_close_matches(name, others, n=1)
    if similar:
        return f'{part} has no {name}; is it called {shorten(similar[0], 40)}?'
    return f'{part} has no {name}'


def _all(found: Definition, but: object = None) -> list[str]:
    return [name for here in found.sections if here is not but for name in here]


def differences(found: Definition, wanted: Definition, kind: str) -> list[str]:
    """A clause for each difference between a definition and the wanted one."""
    names = [list(here) for here in wanted.sections]
    if faults := wrong_names(found, names, kind):
        return faults
    pairs = [
        (here[name], member)
        for here, there in zip(found.sections, wanted.sections, strict=True)
        for name, member in there.items()
    ]
    return [fault for member, other in pairs if (fault := _difference(member, other))]


def _difference(found: DefinedMember, wanted: DefinedMember) -> str:
    name = found.name
    if wanted.is_constant and not found.is_constant:
        return f'{name} is a field: a constant has = and its value after the name'
    if found.is_constant and not wanted.is_constant:
        return f'{name} is a constant: a default value is written without ='
    if fault := _type_difference(name, found.type, wanted.type):
        return fault
    if found.value == wanted.value:
        return ''
    if wanted.is_constant:
        return f'the constant {name} has another value than the table says'
    if wanted.value is None:
        # such a default changes nothing: rosidl fills in the same without it
        is_as_ever = _is_zero(found.value) and _is_array(found.type) in ('', 'fixed')
        if is_as_ever or found.value == []:
            return ''
        return f'the table asks for no default value of {name}'
    if found.value is None:
        return f'{name} has no default value: write it after the name, without ='
    return f'{name} has another default value than the table says'


def _type_difference(name: str, found: Any, wanted: Any) -> str:
    """A clause on how two types differ, or ''; the type of a constant is a string."""
    one, other = (_base(type_) for type_ in (found, wanted))
    if one != other:
        return f'{name} is of type {shorten(one, 60)}: {_about_types(one, other)}'
    for is_wrong, words in (
        (_is_array(found) != _is_array(wanted), _about_arrays(name, found)),
        (
            _size(found) != _size(wanted),
            f'{name} has another number of values than the table says',
        ),
        (
            _bound(found) != _bound(wanted),
            f'{name} is a text of another length than the table says',
        ),
    ):
        if is_wrong:
            return words
    return ''


def _about_types(found: str, wanted: str) -> str:
    if found.startswith('std_msgs/') and found.partition('/')[2].lower() == wanted:
        return f'that is a message of its own, so write the plain type, {wanted}'
    numbers = [type_ for type_ in (found, wanted) if type_.rstrip('0123456789') in _NUMBERS]
    if len(numbers) == 1:
        return 'see in the table whether it is a number'
    if not numbers:
        return 'see in the table what it is'
    kinds = [_NUMBERS[type_.rstrip('0123456789')] for type_ in numbers]
    if kinds[0] != kinds[1]:
        return f'the table asks for {kinds[1]}'
    return 'the table asks for another number of bits'


_NUMBERS = {
    'int': 'whole numbers that may be negative',
    'uint': 'whole numbers that are never negative',
    'float': 'floating-point numbers',
}


def _about_arrays(name: str, found: Any) -> str:
    size = _size(found)
    kind = {
        'fixed': f'exactly so many values, [{size}]',
        'bounded': f'at most so many values, [<={size}]',
        'unbounded': 'any number of values, []',
        '': 'one value, without brackets',
    }[_is_array(found)]
    return f'{name} takes {kind}: see how many the table asks for'


def _base(type_: Any) -> str:
    """The name of a type without its brackets and bounds."""
    if isinstance(type_, str):
        return _SAME.get(type_, type_)
    name = type_.type if type_.pkg_name is None else f'{type_.pkg_name}/{type_.type}'
    return _SAME.get(name, name)


def _is_array(type_: Any) -> str:
    """'fixed', 'bounded' or 'unbounded'; '' if the type is not an array."""
    if isinstance(type_, str) or not type_.is_array:
        return ''
    if type_.array_size is None:
        return 'unbounded'
    return 'bounded' if type_.is_upper_bound else 'fixed'


def _size(type_: Any) -> int | None:
    return None if isinstance(type_, str) else type_.array_size


def _bound(type_: Any) -> int | None:
    return None if isinstance(type_, str) else type_.string_upper_bound


def _is_zero(value: Any) -> bool:
    return not any(value) if isinstance(value, list) else not value
