"""What a room sees of the machine: the system, Python, the course's package, and nothing else."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import my_robot_basics
from grader.common.checkout import ROOT
from grader.sandbox.font_cache import font_cache

_SYSTEM = ('/usr', '/bin', '/sbin', '/lib', '/lib32', '/lib64', '/libx32')
_SETTINGS = ('ld.so.cache', 'ld.so.conf', 'ld.so.conf.d', 'alternatives', 'fonts', 'localtime')
"""What programs look up under /etc; the machine's users, hosts and secrets are not among it."""
_FONTS = 'fontlist-*.json'


@cache
def sources() -> tuple[Path, ...]:
    """Return what the rooms see and lies outside the system: each has its number in `shown`."""
    package = Path(my_robot_basics.__file__).parents[1]
    return (Path(sys.base_prefix).resolve(), Path(sys.prefix), package, *_font_list())


def shown(seen: str, *, configuration: str) -> list[str]:
    """Return the part of a bwrap command that shows a room all that it sees, read-only.

    `seen` holds `sources()` by their numbers; matplotlib's `configuration` is where the room's
    own will look for its list of fonts.
    """
    base, prefix, package, *fonts = sources()
    options = []
    for name in _SYSTEM:
        if Path(name).is_symlink():
            options += ['--symlink', os.readlink(name), name]
        elif Path(name).is_dir():
            options += ['--ro-bind', name, name]
    for name in _SETTINGS:
        options += ['--ro-bind-try', f'/etc/{name}', f'/etc/{name}']
    for path in {base, Path(sys.base_prefix)}:
        if not path.is_relative_to('/usr'):
            options += ['--ro-bind', f'{seen}/0', str(path)]
    options += _links(base)
    # the course itself is not there, even where it lies inside of what is
    options += ['--tmpfs', str(ROOT)]
    options += ['--ro-bind', f'{seen}/1', str(prefix), '--ro-bind', f'{seen}/2', str(package)]
    options += ['--remount-ro', str(ROOT)]
    for number, path in enumerate(fonts, start=3):
        options += ['--ro-bind', f'{seen}/{number}', f'{configuration}/{path.name}']
    return options


def _links(base: Path) -> list[str]:
    """Lead from the environment's `python` to where it really lies."""
    made, path = [], Path(sys.executable)
    while path.is_symlink():
        target = path.readlink()
        known = ('/usr', '/bin', '/etc', sys.prefix, sys.base_prefix, base)
        if not any(path.is_relative_to(folder) for folder in known):
            made += ['--symlink', str(target), str(path)]
        path = path.parent / target
    return made


def _font_list() -> list[Path]:
    """Return matplotlib's list of fonts, that a room need not make its own for seconds."""
    folder = Path(font_cache())
    if not any(folder.glob(_FONTS)):
        command = [sys.executable, '-c', 'import matplotlib.font_manager']
        subprocess.run(command, check=False, capture_output=True)
    return sorted(folder.glob(_FONTS))
