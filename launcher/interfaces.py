"""What .venv needs beside ROS's wheels: files without their faults, and a line for Python."""

import os
import re
from pathlib import Path

from launcher.environment import Environment
from launcher.installer import version_of
from launcher.made import FOREIGN_HEADERS, LINE, MODULE, WAITS
from launcher.shares import point

EXPORTS = 'share/*/cmake/export_*__rosidl_generator_pyExport.cmake'
"""What CMake reads of an interface package's Python part."""
SOURCED = 'my_robot_basics/my_robot_basics/session/sourced.py'
ENDLESS_WAITS = 'my_robot_basics/my_robot_basics/session/endless_waits.py'


def fix_exports(environment: Environment) -> None:
    """Take the paths of another machine out of the CMake files of ROS's wheels.

    Each is replaced whole: uv links the files of .venv to those of its cache.
    """
    for file in sorted(environment.venv.glob(EXPORTS)):
        text = file.read_text(encoding='utf-8')
        fixed = re.sub(FOREIGN_HEADERS, r'\1 ""', text)
        if fixed != text:
            replace(file, fixed)


def fix_waits(environment: Environment) -> None:
    """Let rclpy's EventsExecutor spin without end: in the wheel it stops its whole process."""
    packages = packages_of(environment)
    file = packages / 'rclpy/experimental/events_executor.py'
    point(packages / f'{WAITS}.py', environment.root / ENDLESS_WAITS)
    line = f'\nimport {WAITS}  # noqa\n'
    if file.exists() and line not in (text := file.read_text(encoding='utf-8')):
        replace(file, f'{text}{line}')


def tell_python(environment: Environment) -> None:
    """Let each Python of .venv look at the workspace that its terminal has sourced."""
    packages = packages_of(environment)
    point(packages / f'{MODULE}.py', environment.root / SOURCED)
    replace(packages / f'{MODULE}.pth', LINE)


def packages_of(environment: Environment) -> Path:
    """Return the folder of .venv that Python imports from."""
    version = version_of(environment.python).rpartition('.')[0]
    packages = environment.venv / f'lib/python{version}/site-packages'
    packages.mkdir(parents=True, exist_ok=True)
    return packages


def replace(file: Path, text: str) -> None:
    """Put a new file in the place of one that may be linked elsewhere, too."""
    part = file.with_name(f'{file.name}.part')
    part.write_text(text, encoding='utf-8')
    os.replace(part, file)
