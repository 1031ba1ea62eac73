"""Output information about a node."""

import argparse
import sys

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.graph import HIDDEN_PREFIX, Graph
from my_robot_basics.ros2.node_name import NodeName


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser,
        'node_name',
        completer=completion.node_names,
        help='Node name to request information',
    )
    parser.add_argument(
        '--include-hidden',
        action='store_true',
        help='Display hidden topics, services, and actions as well',
    )


def main(args: argparse.Namespace) -> str | None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        nodes = graph.nodes(include_hidden=args.include_hidden)
        same = [node for node in nodes if node.full_name == args.node_name]
        if not same:
            return f"Unable to find node '{args.node_name}'"
        if len(same) > 1:
            print(
                f'There are {len(same)} nodes in the graph with the exact name '
                f'"{args.node_name}". You are seeing information about only one of them.',
                file=sys.stderr,
            )
        print(args.node_name)
        for title, names_and_types in _sections(graph, same[0]).items():
            print(f'  {title}:')
            lines = [
                f'    {name}: {", ".join(types)}'
                for name, types in names_and_types
                if args.include_hidden or not _is_hidden(name)
            ]
            print(*lines, sep='\n')
    return None


def _sections(graph: Graph, node: NodeName) -> dict[str, list[tuple[str, list[str]]]]:
    from rclpy import action

    own, name, namespace = graph.node, node.name, node.namespace
    return {
        'Subscribers': own.get_subscriber_names_and_types_by_node(name, namespace),
        'Publishers': own.get_publisher_names_and_types_by_node(name, namespace),
        'Service Servers': own.get_service_names_and_types_by_node(name, namespace),
        'Service Clients': own.get_client_names_and_types_by_node(name, namespace),
        'Action Servers': action.get_action_server_names_and_types_by_node(own, name, namespace),
        'Action Clients': action.get_action_client_names_and_types_by_node(own, name, namespace),
    }


def _is_hidden(name: str) -> bool:
    return any(part.startswith(HIDDEN_PREFIX) for part in name.split('/'))
