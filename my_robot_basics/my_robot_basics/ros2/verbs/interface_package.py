"""Output a list of available interface types within one package."""

import argparse

from my_robot_basics.ros2 import completion, interfaces, packages
from my_robot_basics.ros2.verbs.interface_list import add_kinds


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    add_kinds(parser)
    completion.add_argument(
        parser,
        'package_name',
        completer=completion.interface_packages,
        help="Name of the ROS package (e.g. 'example_interfaces')",
    )


def main(args: argparse.Namespace) -> str | None:
    """Run the verb."""
    if packages.prefix(args.package_name) is None:
        return f"Unknown package '{args.package_name}'"
    # without options, ros2cli sorts all names; with options, it prints kind by kind
    chosen = [kind for kind in interfaces.KINDS if kind in (args.kinds or ())]
    for kind in chosen or sorted(interfaces.KINDS):
        for name in interfaces.names(kind):
            if name.startswith(f'{args.package_name}/'):
                print(name)
    return None
