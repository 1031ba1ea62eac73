"""Parse texts of .msg, .srv and .action files as rosidl does, and collect all their faults."""

import re
import textwrap
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import Any

from my_robot_basics.feedback.errors import shorten
from my_robot_basics.ros2.definition_lines import BadLine, parse_line, parse_whole

MOST_CHARACTERS = 10_000
MOST_LINES = 200
SECTIONS = {
    'msg': ('the message',),
    'srv': ('the request', 'the response'),
    'action': ('the goal', 'the result', 'the feedback'),
}
"""The names of a file's parts, by its kind."""
SEPARATOR = '---'
_DASHES = re.compile(r'\s*[-–—_=]{2,}\s*(?:#.*)?')


@dataclass(frozen=True)
class DefinedMember:
    """A field or a constant."""

    name: str
    type: Any
    """For a field, rosidl's Type; for a constant, the type's name."""
    value: Any
    """For a field, its default value or None; for a constant, its value."""
    is_constant: bool


@dataclass
class Definition:
    """The content of a definition's text."""

    sections: list[dict[str, DefinedMember]]
    """The members of each part of the file, by name."""
    faults: list[str] = field(default_factory=list)
    """A clause for each fault that rosidl refuses or cannot build."""


def read_definition(
    text: str, *, package: str, kind: str, own_types: Collection[str]
) -> Definition:
    """Parse a text as a file of that package; `kind` is 'msg', 'srv' or 'action'.

    `own_types` are the message types that the package will have. A common indentation of all
    lines is removed, as it comes from the notebook.
    """
    names = SECTIONS[kind]
    definition = Definition([{} for _ in names])
    try:
        lines = code_lines(text)
    except BadLine as error:
        definition.faults.append(str(error))
        return definition
    if not lines:
        definition.faults.append('there is no field yet')
        return definition
    here = 0
    for line in lines:
        if line == SEPARATOR:
            here += 1
            continue
        section = definition.sections[min(here, len(names) - 1)]
        try:
            member = read_line(line, package=package, own_types=own_types)
            if member.name in section:
                raise BadLine(f'there are two of the name {member.name}')
        except BadLine as error:
            definition.faults.append(f'the line {shorten(line, 60)!r}: {error}')
            here += bool(_DASHES.fullmatch(line))
        else:
            section[member.name] = member
    if here != len(names) - 1:
        definition.faults.append(_about_separators(kind, here))
    if not definition.faults:
        _read_whole(definition, package, kind, '\n'.join(lines))
    return definition


def code_lines(text: str) -> list[str]:
    """Return a text's lines without comments and empty lines. Raises BadLine if it is too long."""
    lines = textwrap.dedent(text[: MOST_CHARACTERS + 1].replace('\t', ' ')).splitlines()
    if len(text) > MOST_CHARACTERS or len(lines) > MOST_LINES:
        raise BadLine(f'it is longer than {MOST_CHARACTERS} characters in {MOST_LINES} lines')
    return [code for line in lines if (code := _without_comment(line)).strip()]


def read_line(line: str, *, package: str, own_types: Collection[str]) -> DefinedMember:
    """Parse one line that is not a separator. Raises BadLine."""
    if _DASHES.fullmatch(line):
        raise BadLine(
            'parts are separated by three dashes, ---, and nothing else is in that line, not '
            'even a space'
        )
    parsed = parse_line(package, line)
    if not hasattr(parsed, 'default_value'):
        return DefinedMember(parsed.name, parsed.type, parsed.value, is_constant=True)
    type_ = parsed.type
    if type_.pkg_name == package:
        if type_.type not in own_types:
            fault = f'your own package has no message {type_.type}'
            raise BadLine(_about_unknown(fault, type_.type))
    elif not type_.is_primitive_type() and f'{type_.pkg_name}/msg/{type_.type}' not in _known():
        shown = f'{type_.pkg_name}/{type_.type}'
        raise BadLine(_about_unknown(f'there is no message type {shown}', type_.type))
    return DefinedMember(parsed.name, type_, parsed.default_value, is_constant=False)


def line_meanings(
    text: str, *, package: str, own_types: Collection[str]
) -> Iterator[tuple[str, DefinedMember | str]]:
    """Yield each line without its comment, with its meaning or why it is refused; '' for ---."""
    for line in code_lines(text):
        meaning: DefinedMember | str = ''
        if line != SEPARATOR:
            try:
                meaning = read_line(line, package=package, own_types=own_types)
            except BadLine as error:
                meaning = f'refused: {error}'
        yield line, meaning


def _without_comment(line: str) -> str:
    """Remove a comment and the spaces before it; not beside ---, where rosidl accepts neither."""
    code = line.partition('#')[0].rstrip()
    return line if code.strip() == SEPARATOR else code


def _about_unknown(fault: str, type_name: str) -> str:
    """Return the fault, and the packages that have a type of that name."""
    found = [name.partition('/')[0] for name in _known() if name.endswith(f'/msg/{type_name}')]
    written = [f'{package}/{type_name}' for package in found]
    return f'{fault}: write its package before it, {" or ".join(written)}' if found else fault


def _known() -> list[str]:
    """Return the installed message types."""
    from my_robot_basics.ros2 import interfaces

    return interfaces.names('msg')


def _about_separators(kind: str, found: int) -> str:
    names = SECTIONS[kind]
    if len(names) == 1:
        return 'a message has one part, so no line ---'
    wanted = 'one line ---' if len(names) == 2 else 'two lines ---'
    between = f'{", ".join(names[:-1])} and {names[-1]}'
    return f'there is to be {wanted} between {between}, and there are {found}'


def _read_whole(definition: Definition, package: str, kind: str, code: str) -> None:
    try:
        parse_whole(package, 'Whole', code, kind=kind)
    except BadLine as error:
        definition.faults.append(f'rosidl says: {error}')
