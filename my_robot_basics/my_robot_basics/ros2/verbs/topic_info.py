"""Print information about a topic."""

import argparse

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser,
        'topic_name',
        completer=completion.topic_names,
        help="Name of the ROS topic to get info (e.g. '/chatter')",
    )
    parser.add_argument(
        '--verbose',
        '-v',
        action='store_true',
        help='Prints detailed information like the node name, node namespace, topic type, '
        'topic type hash, GUID, and QoS Profile of the publishers and subscribers to this topic',
    )


def main(args: argparse.Namespace) -> str | None:
    """Run the verb."""
    end = '\n\n' if args.verbose else '\n'
    name = args.topic_name
    with Graph(args) as graph:
        graph.settle()
        types = dict(graph.topics(include_hidden=True)).get(name)
        if types is None:
            return f"Unknown topic '{name}'"
        print('Type:', types[0] if len(types) == 1 else types, end=end)
        ends = {
            'Publisher': graph.node.get_publishers_info_by_topic(name),
            'Subscription': graph.node.get_subscriptions_info_by_topic(name),
        }
        for title, infos in ends.items():
            print(f'{title} count: {len(infos)}', end=end)
            if args.verbose:
                for info in infos:
                    print(info, end=end)
    return None
