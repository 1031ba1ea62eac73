"""Output an interface prototype."""

import argparse

from my_robot_basics.ros2 import completion, interfaces


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'type',
        completer=completion.interface_types,
        help="Show an interface definition (e.g. 'example_interfaces/msg/String')",
    )
    parser.add_argument(
        '--no-quotes', action='store_true', help='if true output has no outer quotes.'
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    prototype = completion.fields_as_yaml(interfaces.sendable_class_for(args.type)())
    print(prototype if args.no_quotes else f'"{prototype}"')
