"""List all interface types available."""

import argparse

from my_robot_basics.ros2 import interfaces

TITLES = {'msg': 'Messages', 'srv': 'Services', 'action': 'Actions'}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    add_kinds(parser)


def add_kinds(parser: argparse.ArgumentParser) -> None:
    """Add the options that select kinds of types; `args.kinds` is a list, or None for all."""
    texts = {'msg': 'message', 'srv': 'service', 'action': 'action'}
    for kind, text in texts.items():
        parser.add_argument(
            f'-{kind[0]}',
            f'--only-{kind}s',
            action='append_const',
            const=kind,
            dest='kinds',
            help=f'Print out only the {text} types',
        )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    for kind, title in TITLES.items():
        if kind in (args.kinds or TITLES):
            print(f'{title}:')
            for name in interfaces.names(kind):
                print(f'    {name}')
