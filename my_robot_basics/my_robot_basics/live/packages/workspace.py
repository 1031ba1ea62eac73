"""A colcon workspace with the student's own copy of this package: its nodes, without the tools.

Run as a module, it is `./course workspace`. Imports nothing that is slow.
"""

import os
import shutil
import sys
from pathlib import Path

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.live.packages.copies import Copied
from my_robot_basics.session import build_tools, classroom
from my_robot_basics.session.arguments import Arguments
from my_robot_basics.session.errors import LiveError, tell
from my_robot_basics.session.overlays import Overlay

NAME = 'my_robot_basics'
PACKAGE = classroom.PACKAGE
CONTENTS = ('package.xml', 'setup.*', 'resource/*', 'test/*.py', f'{NAME}/*.py')
"""Glob patterns of the files of a package of nodes, without those for lessons and commands."""
INTERFACES = 'arm_interfaces'
INTERFACES_CONTENTS = (
    'package.xml',
    'CMakeLists.txt',
    'msg/*.msg',
    'srv/*.srv',
    'action/*.action',
)
REFERENCE = (
    f'{NAME}/kinematics_publisher.py',
    f'{NAME}/kinematics_subscriber.py',
    'setup.py',
)
"""Files that students copy from, to catch up or to start a file again."""
BUILD = f'cd "$ROS_WS" && colcon build --packages-select {NAME} && source install/setup.bash'
LESSONS = PACKAGE.parent / 'notebooks'
"""The root of JupyterLab's file browser."""


class NoPackage(LiveError):
    """The files to copy do not exist."""


def make_workspace(*, refresh: bool | str = False, interfaces: bool = False) -> None:
    """Create the workspace if it is missing, and print its contents.

    With `interfaces`, the package of the arm's service and action is copied, too. Files that the
    student has edited stay as they are. With `refresh`, a changed package is moved aside and
    replaced by the course's; the name of a package refreshes only that one. Raises NoPackage if
    this package is not installed as the course does it.
    """
    if not (PACKAGE / 'package.xml').is_file():
        raise NoPackage(
            f'{PACKAGE} is not the folder of package.xml, expected the package as ./course sets '
            'it up: start the notebook with ./course lab'
        )
    workspace = classroom.workspace()
    _write_reference(workspace / 'reference')
    _make(Copied(PACKAGE, package_folder(), CONTENTS), refresh in (True, NAME))
    if interfaces:
        source, target = PACKAGE.parent / INTERFACES, workspace / 'src' / INTERFACES
        copied = Copied(source, target, INTERFACES_CONTENTS)
        _make(copied, refresh in (True, INTERFACES))
    tell(f'written  {ros_ws_path(workspace / "reference")}: files to copy from')
    _show_in_file_browser(workspace)
    tell("build it in JupyterLab's terminal or in ./course ros-shell:")
    print(f'           {BUILD}')
    if interfaces:
        first, *others = _about_interfaces(workspace).split('\n')
        print(in_language_here(first), *others, sep='\n')


def _make(package: Copied, refresh: bool) -> None:
    """Copy a package if it is missing, and print the state of the copy."""
    changes = package.differences()
    name = ros_ws_path(package.target)
    if refresh and changes:
        tell(f'moved    {ros_ws_path(package.move_aside(make_shelf()))}: your files as they were')
    if not package.target.exists():
        package.make()
        tell(f'made     {name}: the package, yours to edit')
    elif changes:
        tell(f'kept     {name}: you have changed it:')
        for change in changes:
            print(f'           {change}')
        tell('           (./course workspace --refresh moves it aside and starts again)')
    else:
        tell(f'kept     {name}: the package, unchanged')


def _about_interfaces(workspace: Path) -> str:
    """Return how to build the interfaces, or what is wrong with their build."""
    built = Overlay(workspace / 'install' / INTERFACES, INTERFACES)
    is_built = built.prefix.exists()
    if is_built and (sentence := built.fault() or built.difference()):
        return sentence
    if sentence := build_tools.build_problem(INTERFACES):
        return sentence
    words = f'the same for {INTERFACES} (about 15 s):'
    if is_built:
        words = f'{ros_ws_path(built.prefix)} is built; once more {INTERFACES} (about 15 s):'
    return f'{words}\n           {BUILD.replace(NAME, INTERFACES)}'


def _show_in_file_browser(workspace: Path) -> None:
    if workspace != LESSONS.parent / workspace.name or not LESSONS.is_dir():
        return
    for folder in (LESSONS, *(page.parent for page in LESSONS.glob('*/index.ipynb'))):
        link = folder / workspace.name
        if not link.exists() and not link.is_symlink():
            link.symlink_to(os.path.relpath(workspace, folder))


def package_folder() -> Path:
    """Return the folder of the student's own copy of the package."""
    return classroom.workspace() / 'src' / NAME


def make_shelf() -> Path:
    """Return the folder for a student's files that are moved aside, which builds ignore."""
    shelf = classroom.workspace() / 'kept'
    shelf.mkdir(exist_ok=True)
    (shelf / 'COLCON_IGNORE').touch()
    return shelf


def _write_reference(reference: Path) -> None:
    for name in REFERENCE:
        target = reference / 'src' / NAME / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(PACKAGE / name, target)
    (reference / 'COLCON_IGNORE').touch()  # colcon refuses two packages with the same name


def ros_ws_path(path: Path) -> str:
    """Return a path in the workspace that begins with $ROS_WS, for a terminal of the course."""
    return f'$ROS_WS/{path.relative_to(classroom.workspace())}'.removesuffix('/.')


def main(argv: list[str] | None = None) -> str | None:
    """Run `./course workspace`, and return what `sys.exit` takes."""
    parser = Arguments(
        './course workspace',
        description=in_language_here(
            'Make ros_ws/, a colcon workspace with a copy of the packages that is yours to edit.'
        ),
    )
    parser.add_argument(
        '--refresh',
        nargs='?',
        const=True,
        choices=[NAME, INTERFACES],
        metavar='PACKAGE',
        help=in_language_here(
            'move your files aside, and start again with those of the course; PACKAGE: of that '
            'package alone'
        ),
    )
    args = parser.parse_args(argv)
    tell(f'ROS_WS is {classroom.workspace()}')
    try:
        make_workspace(refresh=args.refresh or False, interfaces=True)
    except (OSError, LiveError) as error:
        return f'course: {in_language_here(str(error))}'
    return None


if __name__ == '__main__':
    sys.exit(main())
