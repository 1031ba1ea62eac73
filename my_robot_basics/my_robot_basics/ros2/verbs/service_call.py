"""Call a service."""

import argparse
import sys
import time
from typing import Any

from my_robot_basics.ros2 import completion, lookup, typed_values
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'service_name',
        completer=completion.service_names,
        help="Name of the ROS service to call to (e.g. '/add_two_ints')",
    )
    completion.add_argument(
        parser,
        'service_type',
        completer=completion.service_types_of,
        help="Type of the ROS service (e.g. 'std_srvs/srv/Empty')",
    )
    source = parser.add_mutually_exclusive_group()
    completion.add_argument(
        source,
        'values',
        completer=completion.request_prototype,
        nargs='?',
        default='{}',
        help="Values to fill the service request with in YAML format (e.g. '{a: 1, b: 2}'), "
        'otherwise the service request will be published with default values',
    )
    source.add_argument('--stdin', action='store_true', help='Read values from standard input')
    parser.add_argument(
        '-r', '--rate', metavar='N', type=float, help='Repeat the call at a specific rate in Hz'
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    from my_robot_basics.ros2.interfaces import service_class_for

    if args.rate is not None and not args.rate > 0.0:
        raise CommandError('rate must be greater than zero')
    service_class = service_class_for(args.service_type)
    values = typed_values.parse(sys.stdin.buffer.read() if args.stdin else args.values)
    request = _request(service_class, values)

    package, *_, name = args.service_type.split('/')
    with Graph(args, node_name=f'_ros2cli_requester_{package}_{name}') as graph:
        service_name = lookup.full_name(graph.node, args.service_name, is_service=True)
        client = graph.node.create_client(service_class, service_name)
        if not client.service_is_ready():
            print('waiting for service to become available...')
            graph.wait_until(client.service_is_ready)
        while True:
            called = time.monotonic()
            _call(graph, client, request)
            if args.rate is None:
                return
            graph.sleep(called + 1.0 / args.rate - time.monotonic())


def _request(service_class: Any, values: Any) -> Any:
    from my_robot_basics.ros2.fill import BadValue, fill

    request = service_class.Request()
    try:
        if not isinstance(values, dict):
            kind = type(values).__name__
            raise BadValue(f"Value '{values}' is expected to be a dictionary but is a {kind}")
        fill(request, values)
    except BadValue as error:
        raise CommandError(f'Failed to populate field: {error}') from None
    return request


def _call(graph: Graph, client: Any, request: Any) -> None:
    print(f'requester: making request: {request!r}\n')
    future = client.call_async(request)
    graph.spin_until(future.done)
    if (response := future.result()) is None:
        raise CommandError(f'Exception while calling service: {future.exception()!r}')
    print(f'response:\n{response!r}\n')
