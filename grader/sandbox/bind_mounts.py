"""What a room sees of the machine: the system, Python and the course's package only."""

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
"""What programs need from /etc; the machine's users, hosts and secrets are not included."""
_FONTS = 'fontlist-*.json'


@cache
def mount_sources() -> tuple[Path, ...]:
    """Return what rooms see outside the system folders.

    `bind_mount_options` mounts each by its index here.
    """
    package = Path(my_robot_basics.__file__).parents[1]
    return (Path(sys.base_prefix).resolve(), Path(sys.prefix), package, *_font_list())


def bind_mount_options(seen: str, *, configuration: str) -> list[str]:
    """Return the part of a bwrap command that mounts all that a room sees, read-only.

    The folder `seen` contains `mount_sources()` by their index. The list of fonts is mounted in
    `configuration`, the room's MPLCONFIGDIR, where matplotlib looks for it.
    """
    base, prefix, package, *fonts = mount_sources()
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
    # hide the course itself, even if it is inside one of the folders mounted above
    options += ['--tmpfs', str(ROOT)]
    options += ['--ro-bind', f'{seen}/1', str(prefix), '--ro-bind', f'{seen}/2', str(package)]
    options += ['--remount-ro', str(ROOT)]
    for number, path in enumerate(fonts, start=3):
        options += ['--ro-bind', f'{seen}/{number}', f'{configuration}/{path.name}']
    return options


def _links(base: Path) -> list[str]:
    """Recreate the chain of links from the environment's `python` to the real file."""
    made, path = [], Path(sys.executable)
    while path.is_symlink():
        target = path.readlink()
        known = ('/usr', '/bin', '/etc', sys.prefix, sys.base_prefix, base)
        if not any(path.is_relative_to(folder) for folder in known):
            made += ['--symlink', str(target), str(path)]
        path = path.parent / target
    return made


def _font_list() -> list[Path]:
    """Return matplotlib's font lists: without them, each room would take seconds to make one."""
    folder = Path(font_cache())
    if not any(folder.glob(_FONTS)):
        command = [sys.executable, '-c', 'import matplotlib.font_manager']
        subprocess.run(command, check=False, capture_output=True)
    return sorted(folder.glob(_FONTS))
