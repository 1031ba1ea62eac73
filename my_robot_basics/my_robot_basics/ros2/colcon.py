"""The command `colcon` of .venv: colcon, with a message about missing build tools.

Without a compiler, CMake would fail with two dozen lines that do not say what to install.
"""

import os
import sys
from pathlib import Path

from colcon_core.command import main as run_colcon
from colcon_core.event.output import StderrLine
from colcon_ros.task.ament_cmake.build import AmentCmakeBuildTask

from my_robot_basics.session import build_tools

OLDEST_POLICY = '3.5'
"""CMake 4 refuses files that were written for an older CMake, unless this minimum is set."""


def main() -> int:
    """Run colcon on the command line, and return its exit status."""
    os.environ['VIRTUAL_ENV'] = sys.prefix  # so that CMake finds this Python
    os.environ.setdefault('CMAKE_POLICY_VERSION_MINIMUM', OLDEST_POLICY)
    os.environ['PATH'] = os.pathsep.join([str(Path(sys.prefix, 'bin')), os.environ['PATH']])
    AmentCmakeBuildTask.build = _build
    return run_colcon()


async def _build(task: AmentCmakeBuildTask) -> int:
    """Build a package as colcon does, if this machine can."""
    name = task.context.pkg.name
    if sentence := build_tools.build_problem(name):
        others = f'what needs no compiler is built with: colcon build --packages-skip {name}'
        task.context.put_event_into_queue(StderrLine(f'{sentence}; {others}\n'.encode()))
        return 1
    return await _build_with_cmake(task)


_build_with_cmake = AmentCmakeBuildTask.build
