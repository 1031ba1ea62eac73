"""Create a new ROS 2 package."""

import argparse
from pathlib import Path

from my_robot_basics.ros2 import skeleton
from my_robot_basics.ros2.errors import CommandError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parser.add_argument('package_name', help='The package name')
    parser.add_argument(
        '--description', default=skeleton.TODO, help='The description given in the package.xml'
    )
    parser.add_argument(
        '--license', default=skeleton.NO_LICENSE, help='The license attached to this package'
    )
    parser.add_argument(
        '--destination-directory',
        default=Path.cwd(),
        type=Path,
        help='Directory where to create the package directory',
    )
    parser.add_argument(
        '--build-type',
        default='ament_cmake',
        choices=['cmake', 'ament_cmake', 'ament_python'],
        help='The build type to process the package with',
    )
    parser.add_argument(
        '--dependencies', nargs='+', default=[], metavar='DEPENDENCY', help='list of dependencies'
    )
    parser.add_argument('--maintainer-email', default='', help='email address of the maintainer')
    parser.add_argument('--maintainer-name', default='', help='name of the maintainer')
    parser.add_argument('--node-name', default='', help='name of the empty executable')


def main(args: argparse.Namespace) -> str | None:
    """Run the verb. Raises CommandError."""
    name, above = args.package_name, args.destination_directory
    if args.build_type != 'ament_python':
        raise CommandError(
            f'this ros2 makes no package of the build type {args.build_type}: give '
            '--build-type ament_python'
        )
    for word in filter(None, (name, args.node_name)):
        if not skeleton.NAME.fullmatch(word):
            raise CommandError(f'{word!r} is no name: use small letters, digits and _')
    if not above.is_dir():
        raise CommandError(f'there is no directory {above}')
    try:
        made = skeleton.make(
            above,
            name,
            node_name=args.node_name,
            dependencies=args.dependencies,
            description=args.description,
            license=args.license,
            maintainer=args.maintainer_name,
            email=args.maintainer_email,
        )
    except FileExistsError:
        raise CommandError(
            f"Aborted!\nThe directory '{name}' already exists. Either change the directory or "
            'remove it'
        ) from None
    print('going to create a new package')
    print('package name:', name)
    print('destination directory:', above.resolve())
    print('build type:', args.build_type)
    print('dependencies:', args.dependencies)
    if args.node_name:
        print('node_name:', args.node_name)
    print(*(f'creating ./{name}/{path}' for path in made), sep='\n')
    return None
