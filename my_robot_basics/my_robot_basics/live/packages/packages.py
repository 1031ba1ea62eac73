"""A ROS package beside the notebook: create it, build it, run its executables."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from my_robot_basics.live.packages import executables, package_build, package_signals
from my_robot_basics.live.packages.package_build import Build
from my_robot_basics.live.packages.workspace import ros_ws_path
from my_robot_basics.ros2 import skeleton
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import NotRunnable, tell

FOLDER = 'MY_ROBOT_BASICS_PACKAGES'
"""The environment variable with the folder of the submitted packages, at grading."""
MOST_SAID = 2_000
"""How many characters of a program's output, or of a message, a check gets."""

_builds: dict[str, Build] = {}


def build_package(name: str) -> None:
    """Build the package beside the notebook, as `colcon build` does, and print the result.

    colcon's results are in the workspace, and the folder is not changed. Running executables of
    the package are stopped first. A fault is printed with what to do, and not raised.
    """
    __tracebackhide__ = True
    _expect_name(name)
    classroom.enter()
    executables.stop_started(package=name)
    _builds.pop(name, None)
    folder = packages_folder() / name
    if folder.is_dir() and not folder.is_symlink():
        built = package_build.build(name, folder)
    else:
        built = Build(name, None, _no_folder(name))
    _builds[name] = built
    tell(_build_message(built), in_one=False)
    for clause in built.left_out:
        tell(f'not handed in, and not built: {clause}', in_one=False)
    for clause in built.undeclared:
        tell(clause, in_one=False)


def run_executable(package: str, executable: str, *arguments: str) -> bool:
    """Start an executable of a package that was built, as `ros2 run` does, in the background.

    `run_executable('arm_player', 'arm_driver', '--ros-args', '-p', 'speed:=0.5')` starts a
    process, whose output appears with the cell. If it runs already, it is replaced. If there is no
    such executable, this is printed with what to do, and not raised, so that *Run All* continues.
    Returns whether it was started.
    """
    executables.stop_started(package=package, name=executable)
    try:
        executables.start(package, executable, arguments)
    except NotRunnable as error:
        tell(f'not started: {_why_not_started(package, error)}', in_one=False)
        return False
    return True


def make_package(name: str, *, node_name: str = '', dependencies: Sequence[str] = ()) -> None:
    """Create a new package beside the notebook, as `ros2 pkg create` does for ament_python.

    `node_name` is the name of a first executable. Raises NotRunnable if the folder exists.
    """
    __tracebackhide__ = True
    _expect_name(name)
    try:
        made = skeleton.make(
            packages_folder(), name, node_name=node_name, dependencies=tuple(dependencies)
        )
    except FileExistsError:
        raise NotRunnable(
            f'expected no folder {name}/ beside the notebook, saw one: go on with that, or rename '
            'it and run this cell again'
        ) from None
    tell(f'made {name}/ beside the notebook:')
    print(*(f'  {path}' for path in made), sep='\n')


def packages_folder() -> Path:
    """Return the folder of a notebook's packages: its own, or at grading the one of FOLDER."""
    return Path(os.environ.get(FOLDER) or Path.cwd())


def answer_check(package: str, verb: str, *args: Any) -> dict[str, Any]:
    """Answer a check's request about a package with bounded text and numbers only.

    'built': the result of the build. 'start', name, arguments: start an executable. 'state',
    number: its exit code, None while it runs, and last output. 'signal', number, name: send that.
    'handlers': whether its code handles SIGINT itself, and whether it waits in a client's `call`.
    """
    if verb == 'built':
        return _build_reply(_builds.get(package))
    if verb == 'start':
        name, arguments = args
        executables.stop_started(package=package, by_notebook_alone=True)
        try:
            number, _ = executables.start(package, name, list(arguments), by_check=True)
        except (NotRunnable, OSError) as error:
            return {'problem': _why_not_started(package, error)[:MOST_SAID]}
        return {'number': number}
    if verb == 'handlers':
        folder = packages_folder() / package
        return {
            'own': package_signals.handles_ctrl_c(folder),
            'calls': package_signals.waits_in_call(folder),
        }
    number, *rest = args
    if (found := executables.find(number)) is None:
        return {'problem': 'nothing was started under that number'}
    if verb == 'signal':
        found.process.send(executables.signal.Signals[rest[0]])
    elif found.process.code is not None:
        found.process.wait_for_lines()
    code = found.process.code
    return {'code': code, 'said': '\n'.join(found.process.lines)[-MOST_SAID:]}


def _why_not_started(package: str, error: Exception) -> str:
    """Return the fault of the build, if it has one: that is why there is no executable."""
    built = _builds.get(package)
    return built.problem if built and built.problem else str(error)


def _build_reply(built: Build | None) -> dict[str, Any]:
    if built is None:
        return {'status': None, 'problem': '', 'words': '', 'executables': [], 'found': False}
    return {
        'found': True,
        'status': built.status,
        'problem': built.problem[:MOST_SAID],
        'words': built.words[-MOST_SAID:],
        'executables': [name[:100] for name in built.executables[:50]],
    }


def _build_message(built: Build) -> str:
    if built.problem:
        return built.problem
    where = ros_ws_path(package_build.prefix_of(built.package))
    known = ', '.join(built.executables)
    return f'built {built.package} in {where}: `ros2 run {built.package}` finds {known}'


def _no_folder(name: str) -> str:
    return (
        f'there is no folder {name}/ beside this notebook: make it there, with the file browser '
        f'or in a terminal, or begin with make_package({name!r})'
    )


def _expect_name(name: str) -> None:
    if not skeleton.NAME.fullmatch(name):
        raise NotRunnable(
            f'expected the name of a package, saw {name!r}: use small letters, digits and _, and '
            'begin with a letter'
        )
