"""Print information about an action."""

import argparse
from collections.abc import Callable
from typing import Any

from my_robot_basics.ros2 import completion, lookup
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'action_name',
        completer=completion.action_names,
        help="Name of the ROS action to get info (e.g. '/fibonacci')",
    )
    parser.add_argument(
        '-t', '--show-types', action='store_true', help='Additionally show the action type'
    )
    parser.add_argument(
        '-c',
        '--count',
        action='store_true',
        help='Only display the number of action clients and action servers',
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        from rclpy import action

        full_name = lookup.full_name(graph.node, args.action_name)
        graph.settle()
        ends = {
            'clients': _ends(graph, full_name, action.get_action_client_names_and_types_by_node),
            'servers': _ends(graph, full_name, action.get_action_server_names_and_types_by_node),
        }
    print(f'Action: {args.action_name}')
    for title, nodes in ends.items():
        print(f'Action {title}: {len(nodes)}')
        for node_name, types in [] if args.count else nodes:
            shown = f' [{", ".join(types)}]' if args.show_types else ''
            print(f'    {node_name}{shown}')


def _ends(graph: Graph, name: str, look_up: Callable[..., Any]) -> list[tuple[str, list[str]]]:
    """Return the nodes at one end of an action, also hidden ones: full names and types."""
    found = []
    for node in graph.nodes(include_hidden=True):
        try:
            actions = dict(look_up(graph.node, node.name, node.namespace))
        except RuntimeError:  # the node has ended meanwhile
            continue
        if name in actions:
            found.append((node.full_name, actions[name]))
    return found
