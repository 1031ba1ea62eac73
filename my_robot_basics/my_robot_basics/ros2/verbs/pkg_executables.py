"""Output a list of package specific executables."""

import argparse

from my_robot_basics.ros2 import completion, packages


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'package_name',
        completer=completion.package_names,
        nargs='?',
        help='The package name',
    )
    parser.add_argument(
        '--full-path', action='store_true', help='Show full path of each executable'
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    names = packages.names() if args.package_name is None else [args.package_name]
    for name in names:
        for path in packages.executables(name):
            print(path if args.full_path else f'{name} {path.name}')
