"""What a result depends on: the versions in use, and a hash of the code."""

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
"""Packages that a report names; the hash includes everything that is installed."""
METADATA = ('.dist-info', '.egg-info')
"""How names of folders end that describe an installed distribution."""


def versions() -> dict[str, str]:
    """Return the versions of Python, the system and the most important packages, for a report."""
    return {
        'Python': platform.python_version(),
        'system': f'{platform.system()} {platform.release()}',
        **{name: version(name) for name in REPORTED},
        'grader and my_robot_basics': software_hash()[:12],
    }


@cache
def software_hash() -> str:
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
    """Yield the folder name of each distribution's metadata, which has its name and version.

    importlib.metadata would read and parse all of the metadata.
    """
    with os.scandir(folder) as entries:
        yield from (each.name for each in entries if each.name.endswith(METADATA))


def _code(folder: str) -> Iterator[str]:
    """Yield the paths of all files in it except `__pycache__`, always in the same order."""
    with os.scandir(folder) as entries:
        for each in sorted(entries, key=lambda entry: entry.name):
            if each.is_file():
                yield each.path
            elif each.is_dir(follow_symlinks=False) and each.name != '__pycache__':
                yield from _code(each.path)
