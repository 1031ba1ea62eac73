"""Explain how rosidl understands the text of a .msg, .srv or .action file, line by line."""

from collections.abc import Collection

from my_robot_basics.exchange.expected_types import brief, with_article
from my_robot_basics.feedback.errors import shorten
from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.ros2.definitions import DefinedMember, line_meanings
from my_robot_basics.session.errors import WrongType

PACKAGE = 'turn_interfaces'
"""The package of lesson 10's exercise."""
_WIDTH = 40


def show_definition(text: str, *, own_types: Collection[str] = (), package: str = PACKAGE) -> None:
    """Print what each line of a definition means to rosidl, or why it is refused.

    `package` is the file's package, and `own_types` has the names of its messages. Raises
    WrongType if the definition is not a str.
    """
    __tracebackhide__ = True
    if not isinstance(text, str):
        seen = f'{with_article(type(text).__name__)} ({brief(text)})'
        raise WrongType(
            f'expected a definition to be a text, saw {seen}: write its lines between """ and """'
        )
    lines = [
        (
            shorten(line),
            _describe_member(meaning) if isinstance(meaning, DefinedMember) else meaning,
        )
        for line, meaning in line_meanings(text, package=package, own_types=own_types)
    ]
    width = min(_WIDTH, max((len(line) for line, _ in lines), default=0))
    for line, words in lines:
        print(f'{line:<{width}}  {in_language_here(words)}'.rstrip())


def _describe_member(member: DefinedMember) -> str:
    if member.is_constant:
        return f'constant {member.name}, {member.type}, always {member.value!r}'
    type_ = _describe_type(member.type)
    if member.value is None:
        return f'field {member.name}, {type_}'
    return f'field {member.name}, {type_}, {member.value!r} if nobody sets it'


def _describe_type(type_: object) -> str:
    """Return a type in words: 'exactly 2 float64'."""
    name, brackets, size = str(type_).partition('[')
    size = size.removesuffix(']')
    if not brackets:
        return name
    if not size:
        return f'any number of {name}'
    return f'at most {size[2:]} {name}' if size.startswith('<=') else f'exactly {size} {name}'
