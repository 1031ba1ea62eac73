"""Show all of the parameters of a node in a YAML file format."""

import argparse
from typing import Any

from my_robot_basics.ros2 import parameters
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parameters.add_node(parser)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    import yaml
    from rclpy.parameter import parameter_value_to_python

    with Graph(args) as graph:
        services = parameters.services_of(graph, args)
        names = services.names()
        values = services.values(names)
    tree: dict[str, Any] = {}
    # the node returns no values if one parameter is not set; ros2cli prints only its name then
    for name, value in zip(names, values, strict=False):
        _insert(tree, name, parameter_value_to_python(value))
    node_name = parameters.absolute(args.node_name)
    print(yaml.dump({node_name: {'ros__parameters': tree}}, default_flow_style=False))


def _insert(tree: dict[str, Any], name: str, value: Any) -> None:
    """Insert a value into nested dicts: `a.b` is `b` inside `a`. Raises CommandError."""
    *parents, leaf = name.split('.')
    for parent in parents:
        tree = tree.setdefault(parent, {})
        if not isinstance(tree, dict):
            raise CommandError(
                f"YAML can't have the parameter {name!r}: {parent!r} is a parameter with a value"
            )
    tree[leaf] = value
