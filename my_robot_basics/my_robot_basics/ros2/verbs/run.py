"""Run a package specific executable."""

import argparse
import shlex

from my_robot_basics.ros2 import completion, environment, packages
from my_robot_basics.ros2.errors import CommandError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        '--prefix',
        help='Prefix command, which should go before the executable. Command must be wrapped in '
        "quotes if it contains spaces (e.g. --prefix 'gdb -ex run --args').",
    )
    completion.add_argument(
        parser, 'package_name', completer=completion.package_names, help='Name of the ROS package'
    )
    completion.add_argument(
        parser,
        'executable_name',
        completer=completion.executable_names,
        help='Name of the executable',
    )
    parser.add_argument(
        'argv',
        nargs=argparse.REMAINDER,
        help='Pass arbitrary arguments to the executable',
    )


def main(args: argparse.Namespace) -> int:
    """Run the command, and return the exit status of the executable."""
    from my_robot_basics.ros2.supervise import run

    try:
        prefix = shlex.split(args.prefix or '')
    except ValueError as error:
        raise CommandError(f'--prefix: {error}: {args.prefix!r}') from None
    paths = packages.executables(args.package_name)
    paths = [path for path in paths if path.name == args.executable_name]
    if not paths:
        raise CommandError('No executable found')
    if len(paths) > 1:
        raise CommandError('\n- '.join(['Multiple executables found:', *map(str, paths)]))
    environment.print_joined_lesson()
    return run([*prefix, str(paths[0]), *args.argv])
