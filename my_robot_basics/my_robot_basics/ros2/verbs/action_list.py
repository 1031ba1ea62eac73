"""Output a list of action names."""

import argparse

from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        '-t', '--show-types', action='store_true', help='Additionally show the action type'
    )
    parser.add_argument(
        '-c',
        '--count-actions',
        action='store_true',
        help='Only display the number of actions discovered',
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        actions = graph.actions()
    if args.count_actions:
        print(len(actions))
        return
    for name, types in actions:
        print(f'{name} [{", ".join(types)}]' if args.show_types else name)
