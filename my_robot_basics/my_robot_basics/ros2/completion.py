"""Completions that the shell offers after Tab: names on the graph, and installed names."""

import argparse
from collections.abc import Callable, Iterable
from typing import Any

from my_robot_basics.ros2 import interfaces
from my_robot_basics.ros2.graph import Graph


def add_argument(
    parser: argparse._ActionsContainer,
    *names: str,
    completer: Callable[..., Iterable[str]],
    **options: Any,
) -> None:
    """Add an argument with a completer, in the attribute that argcomplete reads."""
    vars(parser.add_argument(*names, **options))['completer'] = completer


def topic_names(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the names of topics."""
    with Graph(parsed_args) as graph:
        graph.settle()
        include_hidden = getattr(parsed_args, 'include_hidden_topics', False)
        return [name for name, _ in graph.topics(include_hidden=include_hidden)]


def topic_and_service_names(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the names of topics, and of services except those that every node has."""
    from my_robot_basics.graph.services import OF_EVERY_NODE

    with Graph(parsed_args) as graph:
        graph.settle()
        names = [name for name, _ in graph.topics() + graph.services()]
    return [name for name in names if name.rpartition('/')[2] not in OF_EVERY_NODE]


def topic_types(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the types of the topic; all message types if it has none yet."""
    with Graph(parsed_args) as graph:
        graph.settle()
        topics = dict(graph.topics(include_hidden=True))
    return topics.get(parsed_args.topic_name) or message_types()


def service_types_of(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the types of the service; all service types if it has none yet."""
    with Graph(parsed_args) as graph:
        graph.settle()
        services = dict(graph.services(include_hidden=True))
    return services.get(parsed_args.service_name) or service_types()


def service_types(**_: object) -> list[str]:
    """Return the installed service types."""
    return interfaces.names('srv')


def action_types_of(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the types of the action; all action types if it has none yet."""
    with Graph(parsed_args) as graph:
        graph.settle()
        actions = dict(graph.actions())
    return actions.get(parsed_args.action_name) or interfaces.names('action')


def message_types(**_: object) -> list[str]:
    """Return the installed message types."""
    return interfaces.names('msg')


def interface_types(**_: object) -> list[str]:
    """Return the installed interface types of all kinds."""
    return sorted(name for kind in interfaces.KINDS for name in interfaces.names(kind))


def interface_packages(**_: object) -> list[str]:
    """Return the packages with interface types."""
    return interfaces.packages()


def prototype(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return a message with its default values, as YAML."""
    return [fields_as_yaml(interfaces.message_class_for(parsed_args.message_type)())]


def request_prototype(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return a service's request with its default values, as YAML."""
    return [fields_as_yaml(interfaces.service_class_for(parsed_args.service_type).Request())]


def goal_prototype(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return an action's goal with its default values, as YAML."""
    return [fields_as_yaml(interfaces.action_class_for(parsed_args.action_type).Goal())]


def fields_as_yaml(message: Any) -> str:
    """Return a message's fields with their values, as YAML."""
    from my_robot_basics.ros2.as_text import Shortening, as_yaml

    return as_yaml(message, Shortening())


def node_names(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the full names of nodes."""
    include_hidden = getattr(parsed_args, 'include_hidden_nodes', False)
    with Graph(parsed_args) as graph:
        graph.settle()
        return [node.full_name for node in graph.nodes(include_hidden=include_hidden)]


def service_names(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the names of services."""
    with Graph(parsed_args) as graph:
        graph.settle()
        include_hidden = parsed_args.include_hidden_services
        return [name for name, _ in graph.services(include_hidden=include_hidden)]


def action_names(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the names of actions."""
    with Graph(parsed_args) as graph:
        graph.settle()
        return [name for name, _ in graph.actions()]


def package_names(**_: object) -> Iterable[str]:
    """Return the packages in the ament index."""
    from my_robot_basics.ros2 import packages

    return packages.names()


def executable_names(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the executables of the package that is already on the command line."""
    from my_robot_basics.ros2 import packages

    return [path.name for path in packages.executables(parsed_args.package_name)]
