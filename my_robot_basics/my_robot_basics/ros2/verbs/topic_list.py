"""Output a list of available topics."""

import argparse
from collections.abc import Callable

from my_robot_basics.ros2 import arguments, names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    names_and_types.add_list_options(parser, 'topic')
    arguments.add_hidden_topics(parser)
    parser.add_argument(
        '-v', '--verbose', action='store_true', help='List full details about each topic'
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        topics = graph.topics(include_hidden=args.include_hidden_topics)
        if args.verbose and topics and not args.count:
            _print_ends('Published', 'publisher', topics, graph.node.count_publishers)
            _print_ends('Subscribed', 'subscriber', topics, graph.node.count_subscribers)
        else:
            names_and_types.print_list(topics, count=args.count, show_types=args.show_types)


def _print_ends(
    title: str, end: str, topics: list[tuple[str, list[str]]], count: Callable[[str], int]
) -> None:
    print(f'{title} topics:')
    for name, types in topics:
        if number := count(name):
            plural = 's' if number > 1 else ''
            print(f' * {name} [{", ".join(types)}] {number} {end}{plural}')
    print()
