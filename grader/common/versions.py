"""What does the grading: the versions in use, and a hash of the code."""

import hashlib
import os
import platform
import sysconfig
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path

import my_robot_basics

REPORTED = ('ros-jazzy-rclpy', 'nbgrader', 'ipykernel', 'numpy', 'my_robot_basics')
"""What is named to people; the hash holds everything that is installed."""
METADATA = ('.dist-info', '.egg-info')
"""How the name of what tells of an installed distribution ends."""


def versions() -> dict[str, str]:
    """Return what a report says of Python, the system and the packages that matter most."""
    return {
        'Python': platform.python_version(),
        'system': f'{platform.system()} {platform.release()}',
        **{name: version(name) for name in REPORTED},
        'grader and my_robot_basics': machinery()[:12],
    }


@cache
def machinery() -> str:
    """Return a hash of the grader's code, my_robot_basics and everything that is installed."""
    text = hashlib.sha256(f'{platform.python_version()} {platform.machine()}'.encode())
    for distribution in sorted(_installed(sysconfig.get_path('purelib'))):
        text.update(f'\n{distribution}'.encode())
    for package in (Path(__file__).parents[1], Path(my_robot_basics.__file__).parent):
        for path in _code(str(package)):
            content = hashlib.sha256(Path(path).read_bytes()).hexdigest()
            text.update(f'\n{path.removeprefix(str(package))} {content}'.encode())
    return text.hexdigest()


def _installed(folder: str) -> Iterator[str]:
    """Yield name and version of each distribution, as its metadata's place is called.

    importlib reads and parses all of it.
    """
    with os.scandir(folder) as entries:
        yield from (each.name for each in entries if each.name.endswith(METADATA))


def _code(folder: str) -> Iterator[str]:
    """Yield the paths of all files in it but of what Python makes of them, always in one order."""
    with os.scandir(folder) as entries:
        for each in sorted(entries, key=lambda entry: entry.name):
            if each.is_file():
                yield each.path
            elif each.is_dir(follow_symlinks=False) and each.name != '__pycache__':
                yield from _code(each.path)
