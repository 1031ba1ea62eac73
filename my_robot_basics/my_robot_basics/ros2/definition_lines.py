"""Parse one line of a .msg file with rosidl's parser, and explain why it refuses a line."""

import contextlib
import io
import keyword
import re
from typing import Any

from my_robot_basics.feedback.errors import shorten
from my_robot_basics.ros2.definition_characters import about_characters
from my_robot_basics.ros2.definition_types import FORMER, OTHER_NAMES

MOST_CHARACTERS = 300
"""The longest accepted line, without its comment."""

_CONSTANT_NAME = re.compile('[A-Z](?:_?[A-Z0-9])*')
"""The names that rosidl accepts; its own pattern takes hours for some long names."""
_FIELD_NAME = re.compile('[a-z](?:_?[a-z0-9])*')
_PLACE = re.compile(r'\{\w+\}')
_MESSAGE_TYPE = re.compile('([a-z][a-z0-9_]*/)?[A-Z][A-Za-z0-9]*[a-z][A-Za-z0-9]*')


class BadLine(ValueError):
    """A line that a definition can't have; the exception's text is the cause, as a clause."""


def parse_line(package: str, line: str) -> Any:
    """Return rosidl's Field or Constant for a line without its comment.

    `package` is the file's package. Raises BadLine.
    """
    line = line.replace('\t', ' ')
    if len(line) > MOST_CHARACTERS:
        raise BadLine(f'it has {len(line)} characters, and may have {MOST_CHARACTERS}')
    type_name, _, rest = line.partition(' ')
    rest = rest.strip()
    name, equals, _ = (part.strip() for part in rest.partition('='))
    if line[:1] == ' ':
        raise BadLine('rosidl takes no space before the type')
    if equals and not _CONSTANT_NAME.fullmatch(name):
        # not a constant if = belongs to an array's bound, as in int32[<=60]
        about_line = about_characters(line) or _about_form(type_name, rest)
        raise BadLine(about_line or _about_constant(type_name, name))
    try:
        return _parsed(package, line)
    except Exception as error:
        # rosidl passes on what its conversions raise: TypeError, NameError, IndexError, …
        raise BadLine(about_characters(line) or _why(type_name, rest, error)) from None


def parse_whole(package: str, name: str, text: str, *, kind: str) -> None:
    """Let rosidl parse a file's text; `kind` is 'msg', 'srv' or 'action'. Raises BadLine."""
    from rosidl_adapter import parser

    read = {
        'msg': parser.parse_message_string,
        'srv': parser.parse_service_string,
        'action': parser.parse_action_string,
    }
    try:
        with contextlib.redirect_stderr(io.StringIO()):
            read[kind](package, name, text)
    except Exception as error:
        # rosidl may raise any exception: see parse_line
        raise BadLine(shorten(error)) from None


def _parsed(package: str, line: str) -> Any:
    from rosidl_adapter import parser

    with contextlib.redirect_stderr(io.StringIO()):  # a check prints nothing there
        definition: Any = parser.parse_message_string(package, 'Line', line)
    if not definition.fields:
        return definition.constants[0]
    member = definition.fields[0]
    if member.type.pkg_name == package and (fault := _about_type(member.type.type)):
        raise BadLine(fault)  # rosidl takes an unknown type, such as String, for a message
    if keyword.iskeyword(member.name):
        raise BadLine(f'{member.name} is a word of Python, so that no Python node can use it')
    if member.type.is_primitive_type() and member.type.type in FORMER:
        standard = f'builtin_interfaces/{FORMER[member.type.type]}'
        raise BadLine(f'{member.type.type} is a type of ROS 1: write {standard}')
    return member


def _about_constant(type_name: str, name: str) -> str:
    if not name and _CONSTANT_NAME.fullmatch(type_name):
        return 'a constant has its type before its name, like: uint8 OPEN=1'
    if _CONSTANT_NAME.fullmatch(name.upper()):
        return (
            f'= makes a constant, whose name is in capital letters ({name.upper()}); the default '
            'value of a field is written without ='
        )
    if ' ' in name and (about_type := _about_type(type_name)):
        return about_type  # a type of two words, such as unsigned char
    return f'{shorten(name, 40)!r} is no name of a constant: use A to Z, digits and single _'


def _why(type_name: str, rest: str, error: Exception) -> str:
    """Return the cause of rosidl's error, as a clause."""
    if isinstance(error, BadLine):
        return str(error)
    if _PLACE.search(f'{type_name} {rest}'):
        return 'put an f before the quotation mark: Python then puts the value there'
    name, _, default = rest.partition(' ')
    about_name = '' if '=' in rest else _about_name(name)
    if cause := _about_form(type_name, rest) or _about_type(type_name) or about_name:
        return cause
    said = shorten(error, 120)
    if default and 'array ' in said:
        return 'the default value of an array is a list of as many values, like [1, 2]'
    if default and 'parsing ' in said:
        words = shorten(default.strip(), 40)
        return f'a message has no default value: leave out {words!r}, or write # before it'
    return f'rosidl says: {said}'


def _about_form(type_name: str, rest: str) -> str:
    if type_name.startswith(('```', '~~~')):
        return 'this is a mark of Markdown, and no line of the file: leave it out'
    before, equals, _ = type_name.partition('=')
    if not rest and equals and _CONSTANT_NAME.fullmatch(before):
        return 'a constant has its type before its name, like: uint8 OPEN=1'
    if not rest:
        return 'a line has a type and a name, like: float64 speed; a heading begins with #'
    if not re.search(r'\w', type_name):
        return f'a line begins with its type, without {shorten(type_name, 10)!r} before it'
    if type_name == 'const':
        return 'leave out const: a line begins with its type, and = alone makes a constant'
    if type_name.endswith(':') or rest.startswith(':'):
        return 'the type comes first, then the name, without a colon: float64 speed'
    if type_name.endswith(';') or rest.endswith(';'):
        return 'no line ends with a semicolon'
    if rest.startswith('['):
        return 'no space between a type and its brackets: float64[2] name'
    if '[' in type_name and ']' not in type_name and ']' in rest:
        return 'no space inside the brackets of a type: float64[<=2] name'
    first, second = (words.partition('[')[0] for words in (type_name, rest))
    is_type = second in _primitives() or _MESSAGE_TYPE.fullmatch(second)
    if is_type and first not in [*_primitives(), *OTHER_NAMES] and _FIELD_NAME.fullmatch(first):
        return 'the type comes first, then the name: float64 speed'
    # the brackets behind = are those of a value
    if '[' in re.split('[ =]', rest)[0] and type_name not in OTHER_NAMES:
        return 'brackets belong to the type: float64[2] name'
    return ''


def _about_type(type_name: str) -> str:
    plain, _, brackets = type_name.partition('[')
    if brackets and not re.fullmatch(r'(<=)?\d*\]', brackets):
        return 'an array is written [], exactly two values [2], at most two [<=2]'
    if plain.startswith(('string<', 'wstring<')):
        return 'a text of at most ten characters is written string<=10'
    if re.search('<[A-Za-z]', plain):
        return 'an array is written [], exactly two values [2], at most two [<=2]'
    if '<' in plain:
        return 'at most two values are written with brackets: float64[<=2]'
    if plain in OTHER_NAMES:
        return f'there is no type {plain}: write {OTHER_NAMES[plain]}'
    if plain in _primitives():
        return ''
    if plain.lower() in _primitives() and plain.lower() not in FORMER:
        return f'types are written in lower case: {plain.lower()}'
    parts = [part for part in re.split(r'::|[./]', plain) if part]
    if parts[-1:] == ['msg'] and plain.endswith('.msg'):
        return f'a type has no .msg after its name: {shorten(plain.removesuffix(".msg"), 40)}'
    if len(parts) == 3 and parts[1] == 'msg':
        return f'in a definition, a type has no msg in its name: {parts[0]}/{parts[2]}'
    if len(parts) == 2 and '/' not in plain:
        return f'a package and its type are written with a slash: {parts[0]}/{parts[1]}'
    if '/' in plain and not re.fullmatch('[a-z][a-z0-9_]*/[A-Z][A-Za-z0-9]*', plain):
        return 'a message of another package is written like std_msgs/Header'
    if len(parts) == 1 and not re.fullmatch('[A-Z][A-Za-z0-9]*', plain):
        fault = f'there is no type {shorten(plain, 40)}'
        if re.fullmatch('[a-z]{1,40}', plain):
            return f'{fault}: the type of a message begins with a capital letter, like Header'
        return fault
    return ''


def _about_name(name: str) -> str:
    if _FIELD_NAME.fullmatch(name):
        return ''
    if _CONSTANT_NAME.fullmatch(name) and len(name) > 1:
        return 'a field has a name in lower case; a constant has = and a value after its name'
    words = re.sub('(?<=[a-z0-9])(?=[A-Z])', '_', name).replace('-', '_').lower()
    proper = re.sub('_+', '_', words).strip('_')
    if _FIELD_NAME.fullmatch(proper):
        return f'the name of a field is in lower case, with single _: {proper}'
    return f'{shorten(name, 40)!r} is no name of a field: use a to z, digits and single _'


def _primitives() -> list[str]:
    from rosidl_adapter.parser import PRIMITIVE_TYPES

    return PRIMITIVE_TYPES
