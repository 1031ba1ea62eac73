"""A colcon workspace with the student's own copy of this package: its nodes, without the tools.

Run as a module, it is `./course workspace`. Imports nothing that is slow.
"""

import argparse
import filecmp
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from my_robot_basics.session import classroom
from my_robot_basics.session.errors import LiveError

NAME = 'my_robot_basics'
PACKAGE = classroom.PACKAGE
REFERENCE = (
    f'{NAME}/kinematics_publisher.py',
    f'{NAME}/kinematics_subscriber.py',
    'setup.py',
)
"""What students copy from, to catch up or to begin a file anew."""
BUILD = f'cd "$ROS_WS" && colcon build --packages-select {NAME} && source install/setup.bash'
LESSONS = PACKAGE.parent / 'notebooks'
"""The root of JupyterLab's file browser."""
_LEFTOVERS = ('.', '__pycache__', 'build', 'install', 'log')
"""How folders begin that programs leave behind."""


class NoPackage(LiveError):
    """The files to copy are not there."""


def make_workspace(*, refresh: bool = False) -> None:
    """Make the workspace where it is missing, and print what is there.

    What the student has edited stays as it is. With `refresh` it is moved aside, and replaced by
    the course's files. Raises NoPackage where these are not installed as the course does it.
    """
    if not (PACKAGE / 'package.xml').is_file():
        raise NoPackage(
            f'{PACKAGE} is not the folder of package.xml, expected the package as ./course sets '
            'it up: start the notebook with ./course lab'
        )
    workspace, package = classroom.workspace(), copy()
    _write_reference(workspace / 'reference')
    changes = _differences(package)
    if refresh and changes:
        print(f'moved    {shown(_move_aside(package))}: your files as they were')
    if not package.exists():
        _copy_package(package)
        print(f'made     {shown(package)}: the package, yours to edit')
    elif changes:
        print(f'kept     {shown(package)}: you have changed it:')
        for change in changes:
            print(f'           {change}')
        print('           (./course workspace --refresh moves it aside and starts again)')
    else:
        print(f'kept     {shown(package)}: the package, unchanged')
    print(f'written  {shown(workspace / "reference")}: files to copy from')
    _show_in_file_browser(workspace)
    print(f"build it in JupyterLab's terminal or in ./course ros-shell:\n           {BUILD}")


def _show_in_file_browser(workspace: Path) -> None:
    if workspace != LESSONS.parent / workspace.name or not LESSONS.is_dir():
        return
    for folder in (LESSONS, *(page.parent for page in LESSONS.glob('*/index.ipynb'))):
        link = folder / workspace.name
        if not link.exists() and not link.is_symlink():
            link.symlink_to(os.path.relpath(workspace, folder))


def copy() -> Path:
    """Return the folder of the student's own copy of the package."""
    return classroom.workspace() / 'src' / NAME


def make_shelf() -> Path:
    """Return the folder for files of a student's that are moved aside; no build looks there."""
    shelf = classroom.workspace() / 'kept'
    shelf.mkdir(exist_ok=True)
    (shelf / 'COLCON_IGNORE').touch()
    return shelf


def _write_reference(reference: Path) -> None:
    for name in REFERENCE:
        target = reference / 'src' / NAME / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(PACKAGE / name, target)
    (reference / 'COLCON_IGNORE').touch()  # two packages of one name can't be built


def _files() -> Iterator[Path]:
    """What a package of nodes consists of: all but what the lessons and the commands need."""
    for pattern in ('package.xml', 'setup.*', 'resource/*', 'test/*.py', f'{NAME}/*.py'):
        yield from (path for path in sorted(PACKAGE.glob(pattern)) if path.is_file())


def _copy_package(copy: Path) -> None:
    """Copy in a way that leaves nothing half done."""
    unfinished = copy.with_name(f'.{NAME}.part')
    shutil.rmtree(unfinished, ignore_errors=True)
    for path in _files():
        target = unfinished / path.relative_to(PACKAGE)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, target)
    unfinished.rename(copy)


def _move_aside(package: Path) -> Path:
    """Put the student's folder where no build finds it, beside those of earlier times."""
    shelf = make_shelf()
    number = 1 + sum(1 for _ in shelf.glob(f'{NAME}_*'))
    return package.rename(shelf / f'{NAME}_{number}')


def _differences(copy: Path) -> list[str]:
    """In words, file by file, how the copy differs from the package."""
    if not copy.exists():
        return []
    ours = {path.relative_to(PACKAGE) for path in _files()}
    there = (path.relative_to(copy) for path in copy.rglob('*') if path.is_file())
    theirs = {
        name for name in there if not any(part.startswith(_LEFTOVERS) for part in name.parts[:-1])
    }
    words = dict.fromkeys(theirs - ours, 'new') | dict.fromkeys(ours - theirs, 'missing')
    for name in ours & theirs:
        if not filecmp.cmp(copy / name, PACKAGE / name, shallow=False):
            words[name] = 'changed'
    return [f'{words[name]:8} {name}' for name in sorted(words)]


def shown(path: Path) -> str:
    """Return a path of the workspace as a terminal of the course understands it."""
    return f'$ROS_WS/{path.relative_to(classroom.workspace())}'.removesuffix('/.')


def main(argv: list[str] | None = None) -> str | None:
    """Run `./course workspace`, and return what `sys.exit` takes."""
    parser = argparse.ArgumentParser('./course workspace', description=make_workspace.__doc__)
    parser.add_argument(
        '--refresh',
        action='store_true',
        help='move your files aside, and start again with those of the course',
    )
    args = parser.parse_args(argv)
    print(f'ROS_WS is {classroom.workspace()}')
    try:
        make_workspace(refresh=args.refresh)
    except (OSError, LiveError) as error:
        return f'course: {error}'
    return None


if __name__ == '__main__':
    sys.exit(main())
