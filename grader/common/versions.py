"""What does the grading: the versions in use, and a hash of the code."""

import hashlib
import platform
import sysconfig
from collections.abc import Iterator
from functools import cache
from importlib.metadata import distributions, version
from pathlib import Path

import my_robot_basics

REPORTED = ('ros-jazzy-rclpy', 'nbgrader', 'ipykernel', 'numpy', 'my_robot_basics')
"""What is named to people; the hash holds everything that is installed."""


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
    # not along sys.path, to which programs add: setuptools brings packages of its own
    installed = distributions(path=[sysconfig.get_path('purelib')])
    for distribution in sorted({f'{each.name}=={each.version}' for each in installed}):
        text.update(f'\n{distribution}'.encode())
    for package in (Path(__file__).parents[1], Path(my_robot_basics.__file__).parent):
        for path in _code(package):
            content = hashlib.sha256(path.read_bytes()).hexdigest()
            text.update(f'\n{path.relative_to(package)} {content}'.encode())
    return text.hexdigest()


def _code(package: Path) -> Iterator[Path]:
    for path in sorted(package.rglob('*')):
        if path.is_file() and '__pycache__' not in path.parts:
            yield path
