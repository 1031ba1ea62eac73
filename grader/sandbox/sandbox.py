"""Two rooms that confine student code: they share a private network; each has its own system.

A holder keeps the network and the rooms' disks while an exercise is judged. bubblewrap builds
each room beside it, and everything in a room ends with the room's first process.
"""

import asyncio
import itertools
import os
import shutil
from pathlib import Path

from grader.common.errors import RoomFailure
from grader.sandbox.bubblewrap import (
    ACCOUNTS,
    DISKS,
    ENVIRONMENT,
    INSIDE,
    KEEPER,
    ROOMS,
    room_command,
    slot_user,
)
from grader.sandbox.cgroup_hierarchies import NoCgroups
from grader.sandbox.cgroups import MemoryEvents, RoomCgroup, SandboxCgroups, join_command
from grader.sandbox.holder import Holder
from grader.sandbox.kernel_paths import Keeper, KernelPaths, make_folder
from grader.sandbox.limits import raise_own_file_limit
from grader.sandbox.memory_watch import watch_memory
from grader.sandbox.seccomp import seccomp_filter
from grader.sandbox.temporary_folders import note_cgroups, own_folder

CLOSE_TIMEOUT_SEC = 10.0
_numbers = itertools.count(1)


class Sandbox:
    """The rooms of one exercise: open() first and close() last, whatever happens between."""

    def __init__(self, *, slot: int) -> None:
        """Prepare; `slot` is a small number that nothing else on this machine uses meanwhile."""
        raise_own_file_limit()
        self._user = slot_user(slot)
        self._watch: asyncio.Future | None = None
        self._killed: set[int] = set()
        self._files: list[int] = []
        self._cgroups = _sandbox_cgroups()
        self._note: Path | None = None
        self._folders = {room: make_folder(room) for room in ROOMS}
        for folder in self._folders.values():
            for name, text in ACCOUNTS.items():
                (folder / 'given' / name).write_text(text)
        given = {room: folder / 'given' for room, folder in self._folders.items()}
        self._holder = Holder(self._user, given)

    async def open(self) -> None:
        """Make the cgroups, the network and the disks. Raises RoomFailure."""
        self._make_cgroups()
        await self._holder.start()
        if self._cgroups is None:
            self._watch = asyncio.ensure_future(watch_memory(self._holder.pids, self._killed))

    def cgroup(self, room: str) -> RoomCgroup | None:
        """Return the cgroup of a room; None if this machine offers no cgroups."""
        return None if self._cgroups is None else self._cgroups.rooms[room]

    def memory_events(self, room: str) -> MemoryEvents:
        """Return whether the memory of a room ran out, and how many processes were killed for it.

        Without cgroups our own watch kills processes, and does not distinguish the rooms.
        """
        if cgroup := self.cgroup(room):
            return cgroup.memory_events()
        return MemoryEvents(limit_reached=bool(self._killed), killed=len(self._killed))

    def paths(self, room: str) -> KernelPaths:
        """Return the paths of the 'student' or the 'test' kernel, for one command."""
        seccomp = self._filter()
        prefix = self._room_command(room, seccomp)
        return KernelPaths(
            self._folders[room],
            self._folders[room],
            inside=INSIDE,
            made=Path(f'/proc/{self._holder.pid}/root{DISKS}/{room}/kernel'),
            prefix=tuple(prefix),
            environment=ENVIRONMENT,
            pass_fds=(seccomp,),
            keeper=self._keeper(room),
        )

    def _keeper(self, room: str) -> Keeper:
        seccomp = self._filter()
        info_fd, tell = os.pipe()
        self._files += [info_fd, tell]
        cgroup = self.cgroup(room)
        return Keeper(
            (*self._room_command(room, seccomp, info_fd=tell), *KEEPER),
            (seccomp, tell),
            info_fd=info_fd,
            user=self._user,
            entrances=cgroup.entrances if cgroup else (),
        )

    def _room_command(self, room: str, seccomp: int, info_fd: int | None = None) -> list[str]:
        command = room_command(
            self._user,
            holder=self._holder.pid,
            room=room,
            seccomp=seccomp,
            info_fd=info_fd,
            counted=self._cgroups is not None,
        )
        return [*join_command(self.cgroup(room)), *command]

    def _make_cgroups(self) -> None:
        if self._cgroups is not None:
            self._note = note_cgroups(self._cgroups.name, self._cgroups.folders)
            try:
                self._cgroups.make()
            except OSError as problem:
                raise RoomFailure(
                    f'the cgroups of a sandbox could not be made: {problem}'
                ) from problem

    def _filter(self) -> int:
        """Return a file descriptor of the system call filter: bubblewrap reads it to its end."""
        seccomp = os.memfd_create('seccomp')
        self._files.append(seccomp)
        os.write(seccomp, seccomp_filter(counted=self._cgroups is not None))
        os.lseek(seccomp, 0, os.SEEK_SET)
        return seccomp

    async def close(self) -> None:
        """Kill whatever still runs in the sandbox, and wait until it is gone."""
        try:
            async with asyncio.timeout(CLOSE_TIMEOUT_SEC):
                if self._watch is not None:
                    self._watch.cancel()
                await self._holder.end()
                await self._remove_cgroups()
        except TimeoutError:
            raise RoomFailure('processes of a sandbox could not be ended') from None
        finally:
            self._holder.close()
            for file in self._files:
                os.close(file)
            self._files = []
            for folder in self._folders.values():
                shutil.rmtree(folder, ignore_errors=True)

    async def _remove_cgroups(self) -> None:
        if self._note is not None:
            assert self._cgroups is not None  # there is a note only if there are cgroups
            while not self._cgroups.remove():
                await asyncio.sleep(0.005)
            self._note.unlink()
            self._note = None


def _sandbox_cgroups() -> SandboxCgroups | None:
    try:
        return SandboxCgroups(f'{own_folder().name}-{next(_numbers)}', ROOMS)
    except NoCgroups:
        return None
