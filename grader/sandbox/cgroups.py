"""A cgroup for each room: Linux itself counts what all processes of the room use together.

It also counts memory that belongs to no single process: shared memory, files in memory, and the
kernel's memory for pipes, sockets and semaphores. Each room has its own limits, so a student can't
use up what the test needs. If cgroups can't be made, `hierarchies` raises the reason.

To find out why a kernel ended, ask its room, while the sandbox is open or afterwards:

    cgroup = sandbox.cgroup('student')      # None if this machine offers no cgroups
    cgroup.memory_limit_bytes               # what all its processes may use together
    events = cgroup.memory_events()
    events.killed                           # how many of its processes were killed for memory
    events.limit_reached                    # whether the room's own limit was the cause

`killed` without `limit_reached` means that memory ran out elsewhere: on the machine, or in the
container around the grader. When the sandbox is closed, the last values are kept.
"""

import contextlib
import os
import shlex
import signal
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from grader.sandbox.cgroup_hierarchies import Hierarchies, hierarchies
from grader.sandbox.limits import CPU_WEIGHT, ROOM_MEMORY_BYTES, ROOM_PROCESSES, ROOM_SOCKET_BYTES

_KEEPERS = 16
"""Processes in a room that are not the student's, but keep the room open."""
_ROUNDING_BYTES = 2**20
"""Tolerance when version 1's highest use is compared with the limit: CPUs reserve pages ahead."""
_SHARES = 1_024
"""cpu.shares of version 1 that correspond to cpu.weight 100 of version 2."""


@dataclass(frozen=True)
class MemoryEvents:
    """Whether the memory of a room ran out."""

    limit_reached: bool = False
    """Whether its processes asked for more than its own limit allows."""
    killed: int = 0
    """How many of its processes Linux has killed because memory ran out."""


@dataclass
class RoomCgroup:
    """The cgroup of one room: one folder in version 2, one for each controller in version 1."""

    version: int
    folders: dict[str, Path]
    memory_limit_bytes: int
    _events: MemoryEvents = field(default=MemoryEvents())

    @property
    def entrances(self) -> tuple[Path, ...]:
        """The files into which a process writes 0 to join, with all that it starts later."""
        return tuple(dict.fromkeys(path / 'cgroup.procs' for path in self.folders.values()))

    def memory_events(self) -> MemoryEvents:
        """Return whether memory ran out; the last values seen if the cgroup was removed."""
        with contextlib.suppress(FileNotFoundError):
            self._events = self._read_events()
        return self._events

    def cpu_sec(self) -> float | None:
        """Return the CPU time in s that its processes have used; None if it is not counted."""
        with contextlib.suppress(OSError):
            if self.version == 2:
                return _numbers(self.folders['memory'] / 'cpu.stat')['usage_usec'] / 1e6
            if folder := self.folders.get('cpuacct'):
                return int((folder / 'cpuacct.usage').read_text('ascii')) / 1e9
        return None

    def make(self) -> None:
        """Make the cgroup, with its limits. Raises OSError."""
        for path in dict.fromkeys(self.folders.values()):
            path.mkdir()
        for controller, settings in _limits(self.version, self.memory_limit_bytes).items():
            for name, value in settings.items() if controller in self.folders else ():
                file = self.folders[controller] / name
                if file.exists():  # there may be none for swap, or for sockets in version 1
                    file.write_text(str(value), encoding='ascii')

    def _read_events(self) -> MemoryEvents:
        memory = self.folders['memory']
        if self.version == 1:
            killed = _numbers(memory / 'memory.oom_control').get('oom_kill', 0)
            most = int((memory / 'memory.max_usage_in_bytes').read_text('ascii'))
            return MemoryEvents(most > self.memory_limit_bytes - _ROUNDING_BYTES, killed)
        numbers = _numbers(memory / 'memory.events')
        return MemoryEvents(numbers['oom'] > 0, numbers['oom_kill'])


class SandboxCgroups:
    """The cgroups of a sandbox: make() first, remove() when all of its processes have ended."""

    def __init__(self, name: str, rooms: Iterable[str]) -> None:
        """Prepare cgroups with a name that is unique on this machine. Raises NoCgroups."""
        where = hierarchies()
        self.name = name
        self._where = Hierarchies(where.version, {k: f / name for k, f in where.folders.items()})
        self.rooms = {
            room: RoomCgroup(
                where.version,
                {k: f / room for k, f in self._where.folders.items()},
                memory_limit_bytes=ROOM_MEMORY_BYTES,
            )
            for room in rooms
        }

    @property
    def folders(self) -> list[Path]:
        """The folders that contain the cgroups of all rooms."""
        return list(dict.fromkeys(self._where.folders.values()))

    def make(self) -> None:
        """Make the cgroups of all rooms. Raises OSError."""
        for folder in self.folders:
            folder.mkdir()
            if self._where.version == 2:
                switched = ' '.join(f'+{controller}' for controller in self._where.folders)
                (folder / 'cgroup.subtree_control').write_text(switched, encoding='ascii')
        if 'cpu' in self._where.folders:
            name, weight = _weight(self._where.version, 2 * CPU_WEIGHT)
            (self._where.folders['cpu'] / name).write_text(weight, encoding='ascii')
        for room in self.rooms.values():
            room.make()

    def remove(self) -> bool:
        """Kill what still runs in the cgroups, and remove them; return whether they are gone."""
        for room in self.rooms.values():
            room.memory_events()
        gone = [remove_cgroup(folder) for folder in self.folders]
        return all(gone)


def join_command(cgroup: RoomCgroup | None) -> list[str]:
    """Return the beginning of a command that runs the rest in a room's cgroup."""
    if cgroup is None:
        return []
    join = ''.join(f'echo 0 >{shlex.quote(str(path))} && ' for path in cgroup.entrances)
    return ['sh', '-c', f'{join}exec "$@"', 'sh']


def remove_cgroup(folder: Path) -> bool:
    """Kill all processes in a cgroup and below; return whether the cgroup could be removed.

    A killed process takes a moment to leave: call it again until it returns True.
    """
    with contextlib.suppress(FileNotFoundError):
        for below in [path for path in folder.iterdir() if path.is_dir()]:
            remove_cgroup(below)
        _kill_all(folder)
        with contextlib.suppress(OSError):  # EBUSY: a process has not left yet
            folder.rmdir()
    return not folder.exists()


def _kill_all(folder: Path) -> None:
    for pid in map(int, (folder / 'cgroup.procs').read_text('ascii').split()):
        if pid > 0:  # 0 is a process of another PID namespace; kill(0) would kill our own group
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)


def _limits(version: int, memory_bytes: int) -> dict[str, Mapping[str, object]]:
    """Return what is written into which files, by controller."""
    if version == 1:
        memory = {
            'memory.limit_in_bytes': memory_bytes,
            'memory.memsw.limit_in_bytes': memory_bytes,
            'memory.kmem.tcp.limit_in_bytes': ROOM_SOCKET_BYTES,  # counted separately
        }
    else:
        memory = {'memory.max': memory_bytes, 'memory.swap.max': 0}
    return {
        'memory': memory,
        'pids': {'pids.max': ROOM_PROCESSES + _KEEPERS},
        'cpu': dict([_weight(version, CPU_WEIGHT)]),
    }


def _weight(version: int, weight: int) -> tuple[str, str]:
    """Return the file that sets a cgroup's share of the processor, and what to write there."""
    return (
        ('cpu.shares', str(weight * _SHARES // 100))
        if version == 1
        else ('cpu.weight', str(weight))
    )


def _numbers(path: Path) -> dict[str, int]:
    lines = path.read_text('ascii').splitlines()
    return {name: int(number) for name, number in map(str.split, lines)}
