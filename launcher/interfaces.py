"""Additions to the ROS wheels in .venv: fixes of their faults, and a startup hook for Python."""

import os
import re
from pathlib import Path

from launcher.environment import Environment
from launcher.installer import version_of
from launcher.shares import make_symlink
from launcher.venv_inputs import FOREIGN_HEADERS, LINE, MODULE, WAITS

EXPORTS = 'share/*/cmake/export_*__rosidl_generator_pyExport.cmake'
"""What CMake reads about the Python part of an interface package."""
SOURCED = 'my_robot_basics/my_robot_basics/session/sourced.py'
ENDLESS_WAITS = 'my_robot_basics/my_robot_basics/session/endless_waits.py'


def fix_exports(environment: Environment) -> None:
    """Remove the paths of the build machine from the CMake files of the ROS wheels.

    Each file is replaced, not changed: uv links the files of .venv to those of its cache.
    """
    for file in sorted(environment.venv.glob(EXPORTS)):
        text = file.read_text(encoding='utf-8')
        fixed = re.sub(FOREIGN_HEADERS, r'\1 ""', text)
        if fixed != text:
            replace(file, fixed)


def fix_waits(environment: Environment) -> None:
    """Let rclpy's EventsExecutor wait without a timeout: else it aborts the process then."""
    packages = packages_of(environment)
    file = packages / 'rclpy/experimental/events_executor.py'
    make_symlink(packages / f'{WAITS}.py', environment.root / ENDLESS_WAITS)
    line = f'\nimport {WAITS}  # noqa\n'
    if file.exists() and line not in (text := file.read_text(encoding='utf-8')):
        replace(file, f'{text}{line}')


def install_startup_hook(environment: Environment) -> None:
    """Let each Python of .venv find packages of the workspace that its terminal has sourced."""
    packages = packages_of(environment)
    make_symlink(packages / f'{MODULE}.py', environment.root / SOURCED)
    replace(packages / f'{MODULE}.pth', LINE)


def packages_of(environment: Environment) -> Path:
    """Return the site-packages folder of .venv."""
    version = version_of(environment.python).rpartition('.')[0]
    packages = environment.venv / f'lib/python{version}/site-packages'
    packages.mkdir(parents=True, exist_ok=True)
    return packages


def replace(file: Path, text: str) -> None:
    """Write a new file in place of one that may be a hard link of another file."""
    part = file.with_name(f'{file.name}.part')
    part.write_text(text, encoding='utf-8')
    os.replace(part, file)
