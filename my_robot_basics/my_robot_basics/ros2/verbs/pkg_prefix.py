"""Output the prefix path of a package."""

import argparse

from my_robot_basics.ros2 import completion, packages


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser, 'package_name', completer=completion.package_names, help='The package name'
    )
    parser.add_argument(
        '--share', action='store_true', help='Show share directory for the package'
    )


def main(args: argparse.Namespace) -> str | None:
    """Run the verb."""
    if (prefix := packages.prefix(args.package_name)) is None:
        return 'Package not found'
    print(prefix / 'share' / args.package_name if args.share else prefix)
    return None
