"""Output the interface definition."""

import argparse
import sys
from collections.abc import Iterator

from my_robot_basics.ros2 import completion, interfaces
from my_robot_basics.ros2.errors import CommandError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    comments = parser.add_mutually_exclusive_group()
    comments.add_argument(
        '--all-comments',
        action='store_true',
        help='Show all comments, including for nested interface definitions',
    )
    comments.add_argument(
        '--no-comments', action='store_true', help='Show no comments or whitespace'
    )
    completion.add_argument(
        parser,
        'type',
        completer=completion.interface_types,
        type=_name,
        help="Show an interface definition (e.g. 'std_msgs/msg/String'). Passing '-' reads the "
        "argument from stdin (e.g. 'ros2 topic type /chatter | ros2 interface show -').",
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    lines = _lines(args.type, comments=not args.no_comments, nested_comments=args.all_comments)
    for line in lines:
        print(line)


def _name(text: str) -> str:
    if text == '-':
        if sys.stdin.isatty():
            raise argparse.ArgumentTypeError('expected stdin pipe')
        text = sys.stdin.readline().strip()
    if not text:
        raise argparse.ArgumentTypeError('the passed value is empty')
    return text


def _lines(name: str, *, comments: bool, nested_comments: bool, indent: str = '') -> Iterator[str]:
    """Yield the definition's lines, and below each field of a message type, that type's lines."""
    package = name.partition('/')[0]
    for line in interfaces.path(name).read_text(encoding='utf-8').splitlines():
        text, nested = _parsed(package, line.rstrip(), comments)
        if text or comments:
            yield f'{indent}{text}' if text else ''
        if nested:
            yield from _lines(
                nested,
                comments=nested_comments,
                nested_comments=nested_comments,
                indent=f'{indent}\t',
            )


def _parsed(package: str, line: str, comments: bool) -> tuple[str, str | None]:
    """Return the line, with or without its comment, and the message type of its field, if any."""
    from rosidl_adapter.parser import InvalidSpecification, parse_message_string

    if line in ('', '---'):
        return line, None
    try:
        definition = parse_message_string(package, 'Line', line)
    except InvalidSpecification as error:
        raise CommandError(f"'{line}' is not a line of an interface definition: {error}") from None
    members = [*definition.fields, *definition.constants]
    if not comments:
        if definition.annotations['comment']:
            return '', None
        if members and (comment := members[0].annotations['comment']):
            line = line[: line.find(comment[0]) - 1].strip()  # ros2cli leaves the `#` of `# text`
    field_type = definition.fields[0].type if definition.fields else None
    if field_type is None or field_type.is_primitive_type():
        return line, None
    return line, f'{field_type.pkg_name}/msg/{field_type.type}'
