"""What does the grading: the versions in use, and a hash of the code."""

import hashlib
import platform
import re
import sysconfig
from collections.abc import Iterator
from functools import cache
from importlib.metadata import distributions, version
from pathlib import Path

import my_robot_basics

REPORTED = ('ros-jazzy-rclpy', 'nbgrader', 'ipykernel', 'numpy', 'my_robot_basics')
"""What is named to people; the hash holds everything that is installed."""
_NAME = re.compile(r'^Name: (\S+)$', re.MULTILINE)
_VERSION = re.compile(r'^Version: (\S+)$', re.MULTILINE)
_HEAD_CHARACTERS = 2_000


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
    for distribution in sorted(set(_installed())):
        text.update(f'\n{distribution}'.encode())
    for package in (Path(__file__).parents[1], Path(my_robot_basics.__file__).parent):
        for path in _code(package):
            content = hashlib.sha256(path.read_bytes()).hexdigest()
            text.update(f'\n{path.relative_to(package)} {content}'.encode())
    return text.hexdigest()


def _installed() -> Iterator[str]:
    """Yield name and version of each distribution, as its metadata begins.

    importlib parses all of it: long texts, and twice.
    """
    # not along sys.path, to which programs add: setuptools brings packages of its own
    for each in distributions(path=[sysconfig.get_path('purelib')]):
        folder = getattr(each, '_path', None)
        head = _head(folder) if folder else ''
        name, version = _NAME.search(head), _VERSION.search(head)
        yield f'{name[1]}=={version[1]}' if name and version else f'{each.name}=={each.version}'


def _head(folder: Path) -> str:
    try:
        with (folder / 'METADATA').open(encoding='utf-8', errors='replace') as file:
            return file.read(_HEAD_CHARACTERS).partition('\n\n')[0]
    except OSError:
        return ''


def _code(package: Path) -> Iterator[Path]:
    for path in sorted(package.rglob('*')):
        if path.is_file() and '__pycache__' not in path.parts:
            yield path
