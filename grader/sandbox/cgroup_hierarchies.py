"""Where this process may make cgroups: in version 2, or in version 1 where that is used.

In version 2 a cgroup that has child cgroups must not contain processes. So graders move into a
cgroup of their own, GRADERS, beside those that they make. They do so only in a tree that is theirs
to use: delegated by systemd (`command_in_scope` asks for it), in a container, or as root without
systemd.
"""

import contextlib
import os
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from grader.sandbox.cgroup_paths import own_paths, reachable_folders
from grader.sandbox.systemd_scopes import SYSTEMD, UNIT, has_scopes, scope_command

GRADERS = 'mrb-graders'
"""The cgroup that graders move into."""
NEEDED, WANTED = ('memory', 'pids'), ('memory', 'pids', 'cpu')
"""The controllers that we can't do without, and all that we use."""
COUNTS = 'cpuacct'
"""The controller that counts CPU time in version 1; in version 2 every cgroup counts it."""
GRADERS_WEIGHT = 1_000
"""cpu.weight of the graders; a sandbox has 200. The grader must answer however many run."""

_MOVES = 10


class NoCgroups(Exception):
    """Why cgroups can't be made here, in a sentence."""


@dataclass(frozen=True)
class Hierarchies:
    """Where cgroups can be made: a folder for each controller, all the same in version 2."""

    version: int
    folders: dict[str, Path]

    def __str__(self) -> str:
        """Return what `./course doctor` prints about it."""
        controllers = ', '.join(self.folders)
        said = f'version {self.version}: {controllers}; in {self.folders["memory"]}'
        return f'{said}; without what {uncounted} hold' if (uncounted := _uncounted()) else said


def hierarchies() -> Hierarchies:
    """Return where this process may make cgroups. Raises NoCgroups if it may not."""
    found = _found(Path('/proc/self'))
    if isinstance(found, NoCgroups):
        raise found
    return found


def command_in_scope(command: tuple[str, ...]) -> tuple[str, ...]:
    """Return the command, run where cgroups can be made, if systemd can provide such a place.

    That is a scope, which `systemd-run` starts for this user, and which ends with the command.
    """
    found = _found(Path('/proc/self'))
    return (
        (*scope_command(), *command) if isinstance(found, NoCgroups) and has_scopes() else command
    )


@cache
def _found(proc: Path) -> Hierarchies | NoCgroups:
    try:
        paths = own_paths(proc)
        if 'memory' in paths:
            wanted = (*WANTED, COUNTS)
            folders = {name: _folder(proc, paths[name], name) for name in wanted if name in paths}
            return Hierarchies(1, _writable(folders))
        if '' not in paths:
            raise NoCgroups('this Linux has no cgroups')
        top = _folder(proc, '/', '') if reachable_folders(proc, '/', '') else None
        folder = _version_2(_folder(proc, paths[''], ''), top)
        controllers = _words(folder / 'cgroup.subtree_control')
        return Hierarchies(2, {name: folder for name in WANTED if name in controllers})
    except NoCgroups as problem:
        return problem
    except OSError as problem:
        return NoCgroups(f'{problem.strerror}: {problem.filename}')


def _uncounted(command_line: Path = Path('/proc/cmdline')) -> str:
    """Return which kinds of memory Linux was booted not to count; '' if it counts all."""
    found = re.findall(r'\bcgroup\.memory=(\S+)', command_line.read_text(errors='replace'))
    options = {option for each in found for option in each.split(',')}
    names = {'nosocket': 'sockets', 'nokmem': 'objects of the kernel'}
    return ' and '.join(name for option, name in names.items() if option in options)


def _folder(proc: Path, path: str, controller: str) -> Path:
    """Return the folder of a cgroup. Raises NoCgroups if it is not mounted here."""
    for folder in reachable_folders(proc, path, controller):
        return folder
    raise NoCgroups(f'the cgroup {path} is not mounted here')


def _writable(folders: dict[str, Path]) -> dict[str, Path]:
    found = {name: path for name, path in folders.items() if os.access(path, os.W_OK | os.X_OK)}
    for name in NEEDED:
        if name not in found:
            raise NoCgroups(
                f'{folders.get(name, f"the controller {name}")} cannot be used by this user'
            )
    return found


def _version_2(own: Path, top: Path | None) -> Path:
    """Return the folder in which graders and sandboxes get cgroups, with controllers enabled."""
    if own.name == GRADERS:
        folder = own.parent
    elif own == top or _delegated(own):
        folder = own
    elif os.geteuid() == 0 and top is not None and not SYSTEMD.is_dir():
        folder = top
    else:
        raise NoCgroups(f'{own} cannot be used by this user: systemd has not delegated it')
    if not os.access(folder, os.W_OK | os.X_OK):
        raise NoCgroups(f'{folder} cannot be used by this user')
    if folder == own and (folder / 'cgroup.type').exists():  # the root may have processes
        _move_to_graders(folder)
    _switch_on(folder)
    return folder


def _delegated(folder: Path) -> bool:
    if folder.name.startswith(UNIT) and folder.suffix == '.scope':
        return True
    for name in ('user.delegate', 'trusted.delegate'):
        with contextlib.suppress(OSError):
            if os.getxattr(folder, name) == b'1':
                return True
    return False


def _move_to_graders(folder: Path) -> None:
    graders = folder / GRADERS
    graders.mkdir(exist_ok=True)
    for _ in range(_MOVES):  # a process that is started meanwhile appears in the old cgroup
        processes = _words(folder / 'cgroup.procs')
        if not processes:
            return
        for process in processes:
            with contextlib.suppress(ProcessLookupError):
                (graders / 'cgroup.procs').write_text(process, encoding='ascii')
    raise NoCgroups(f'{folder} always has new processes in it')


def _switch_on(folder: Path) -> None:
    """Enable the controllers for cgroups in a folder. Raises NoCgroups, OSError."""
    there = _words(folder / 'cgroup.controllers')
    if lacking := [name for name in NEEDED if name not in there]:
        raise NoCgroups(f'{folder} has no controller for {" and ".join(lacking)}')
    for name in WANTED:
        with contextlib.suppress(*([] if name in NEEDED else [OSError])):
            if name not in _words(folder / 'cgroup.subtree_control'):
                (folder / 'cgroup.subtree_control').write_text(f'+{name}', encoding='ascii')
    weight = folder / GRADERS / 'cpu.weight'
    if weight.exists():
        weight.write_text(str(GRADERS_WEIGHT), encoding='ascii')


def _words(path: Path) -> list[str]:
    return path.read_text(encoding='ascii').split()


def main() -> None:
    """Print where cgroups can be made; exit with the reason if they can't."""
    try:
        print(hierarchies())
    except NoCgroups as problem:
        raise SystemExit(str(problem)) from None


if __name__ == '__main__':
    main()
