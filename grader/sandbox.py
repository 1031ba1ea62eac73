"""Two rooms that nothing gets out of: one network of their own, and a system for each.

A holder keeps the network and the rooms' disks while an exercise is judged. bubblewrap builds
each room beside it, and everything in a room dies with its first process.
"""

import asyncio
import contextlib
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from grader.errors import RoomFailure
from grader.limits import ROOM_DISK_BYTES, ROOM_FILES, limited
from grader.places import Place, make_folder
from grader.seccomp import seccomp_filter
from grader.sights import shown, sources

ROOMS = ('student', 'test')
INSIDE = Path('/room')
OPEN_TIMEOUT_SEC = 30.0
CLOSE_TIMEOUT_SEC = 10.0
FIRST_USER = 1_879_048_192
"""Users from here on are nobody's, says systemd."""

_SEEN, _DISKS = '/tmp/seen', '/tmp/disks'
"""Where the holder keeps what the rooms see of the machine, and what they write to."""
_HOLD = f"""
for room in {' '.join(ROOMS)}; do
    mount -t tmpfs -o size={ROOM_DISK_BYTES},nr_inodes={ROOM_FILES} room {_DISKS}/$room || exit 1
    (cd {_DISKS}/$room && mkdir -p kernel home/work tmp shm) || exit 1
done
echo $$
exec cat
"""
_ENVIRONMENT = {
    'HOME': f'{INSIDE}/home',
    'PATH': f'{sys.prefix}/bin:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin',
    'AMENT_PREFIX_PATH': sys.prefix,
    'MPLCONFIGDIR': f'{INSIDE}/home/matplotlib',
    # shared memory does not cross from one room to the other
    'FASTDDS_BUILTIN_TRANSPORTS': 'UDPv4',
    # LOCALHOST would bring it back; the network ends with this submission anyway
    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET',
    # memory that is asked for counts, used or not
    'MALLOC_ARENA_MAX': '2',
    'OPENBLAS_NUM_THREADS': '1',
}
_MACHINE = ('bwrap', '--die-with-parent', '--dev-bind', '/', '/')
_NETWORK = ['--unshare-user', '--uid', '0', '--gid', '0', '--unshare-net']
_NETWORK += ['--cap-add', 'CAP_SYS_ADMIN']  # to mount the disks
_ROOM = [
    '--die-with-parent', '--new-session', '--hostname', 'room', '--uid', '1000', '--gid', '1000',
    '--unshare-user', '--unshare-pid', '--unshare-ipc', '--unshare-uts', '--unshare-cgroup-try',
    '--disable-userns', '--cap-drop', 'ALL',
]  # fmt: skip
_USER = 'student:x:1000:1000:student:/room/home:/bin/sh\n'
_ACCOUNTS = {'passwd': _USER, 'group': 'student:x:1000:\n', 'hosts': '127.0.0.1 localhost room\n'}


class Sandbox:
    """The rooms of one exercise: open() first and close() last, whatever happens between."""

    def __init__(self, *, slot: int) -> None:
        """Prepare; `slot` is a small number that nobody else on this machine uses meanwhile."""
        self._user = slot_user(slot)
        self._holder: subprocess.Popen | None = None
        self._network = -1
        self._filters: list[int] = []
        self._folders = {room: make_folder(room) for room in ROOMS}
        for folder in self._folders.values():
            for name, text in _ACCOUNTS.items():
                (folder / 'given' / name).write_text(text)

    async def open(self) -> None:
        """Make the network and the disks. Raises RoomFailure."""
        self._holder = subprocess.Popen(
            self._holder_command(),
            bufsize=0,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            env={'PATH': f'{os.defpath}:/usr/sbin:/sbin'},
        )
        os.set_blocking(self._holder.stdout.fileno(), False)
        line = b''
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(OPEN_TIMEOUT_SEC):
                while not line.endswith(b'\n') and self._holder.poll() is None:
                    line += self._holder.stdout.read(100) or b''
                    await asyncio.sleep(0.002)
        if not line.strip().isdigit():
            self._kill_holder()
            said = self._holder.stderr.read(10_000).decode(errors='replace').strip()
            raise RoomFailure(f'the sandbox could not be made: {said or "it did not answer"}')
        self._pid = int(line)
        self._network = os.open(f'/proc/{self._pid}/ns/net', os.O_RDONLY)

    def place(self, room: str) -> Place:
        """Return the place of the 'student' or the 'test' kernel, for one command."""
        seccomp = os.memfd_create('seccomp')
        self._filters.append(seccomp)
        os.write(seccomp, seccomp_filter())
        os.lseek(seccomp, 0, os.SEEK_SET)
        return Place(
            self._folders[room],
            Path(f'/proc/{self._pid}/root{_DISKS}/{room}/kernel'),
            inside=INSIDE,
            prefix=tuple(self._room_command(room, seccomp)),
            environment=_ENVIRONMENT,
            pass_fds=(seccomp,),
        )

    async def close(self) -> None:
        """End whatever still runs in it, and wait until it has gone."""
        try:
            if self._holder is not None:
                async with asyncio.timeout(CLOSE_TIMEOUT_SEC):
                    await self._end()
        except TimeoutError:
            raise RoomFailure('processes of a sandbox could not be ended') from None
        finally:
            for file in (*self._filters, self._network):
                if file >= 0:
                    os.close(file)
            self._filters, self._network, self._holder = [], -1, None
            for folder in self._folders.values():
                shutil.rmtree(folder, ignore_errors=True)

    async def _end(self) -> None:
        self._kill_holder()
        while left := list(self._inhabitants()):
            for pid in left:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            await asyncio.sleep(0.01)
        while self._holder.poll() is None:
            await asyncio.sleep(0.005)
        for pipe in (self._holder.stdin, self._holder.stdout, self._holder.stderr):
            pipe.close()

    def _kill_holder(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._holder.pid, signal.SIGKILL)

    def _inhabitants(self) -> Iterator[int]:
        """Yield the processes that have this sandbox's network."""
        if self._network < 0:
            return
        ours = os.fstat(self._network)
        for name in os.listdir('/proc'):
            if name.isdigit():
                # other users' are not ours; others end while we look
                with contextlib.suppress(OSError):
                    if os.path.samestat(os.stat(f'/proc/{name}/ns/net'), ours):
                        yield int(name)

    def _holder_command(self) -> list[str]:
        seen = [
            '--tmpfs', '/tmp', '--dir', _SEEN,
            *_bound(dict(enumerate(sources()))),
            *_bound({room: folder / 'given' for room, folder in self._folders.items()}),
            '--dir', _DISKS,
        ]  # fmt: skip
        disks = ['--tmpfs', _DISKS]
        for room in ROOMS:
            disks += ['--dir', f'{_DISKS}/{room}']
        hold = [*disks, *_NETWORK, '--', 'sh', '-c', _HOLD]
        if self._user is None:
            return [*_MACHINE, *seen, *hold]
        # root first makes reachable what its own slots may not reach, then becomes one of them
        become = ['--cap-add', 'CAP_SETUID', '--cap-add', 'CAP_SETGID', '--', *self._drop()]
        return [*_MACHINE, *seen, *become, *_MACHINE, *hold]

    def _room_command(self, room: str, seccomp: int) -> list[str]:
        disk = f'{_DISKS}/{room}'
        accounts = []
        for name in _ACCOUNTS:
            accounts += ['--symlink', f'{INSIDE}/given/{name}', f'/etc/{name}']
        enter = ['nsenter', '--target', str(self._pid), '--user', '--net', '--mount']
        return [
            *self._drop(),
            *enter, '--preserve-credentials', '--',
            'bwrap', *_ROOM,
            '--proc', '/proc',
            '--dev', '/dev',
            '--bind', f'{disk}/shm', '/dev/shm',
            '--bind', f'{disk}/tmp', '/tmp',
            '--bind', f'{disk}/kernel', f'{INSIDE}/kernel',
            '--bind', f'{disk}/home', f'{INSIDE}/home',
            '--ro-bind', f'{_SEEN}/{room}', f'{INSIDE}/given',
            *shown(_SEEN, configuration=_ENVIRONMENT['MPLCONFIGDIR']),
            *accounts,
            '--remount-ro', '/dev',
            '--remount-ro', '/',
            '--chdir', f'{INSIDE}/home/work',
            '--unsetenv', 'JPY_PARENT_PID',  # a kernel that does not find its parent ends
            '--seccomp', str(seccomp),
            '--', *limited(),
        ]  # fmt: skip

    def _drop(self) -> list[str]:
        if self._user is None:
            return []
        return f'setpriv --reuid {self._user} --regid {self._user} --clear-groups --'.split()


def slot_user(slot: int) -> int | None:
    """Return the user that root becomes for a slot; None where we are no root, or root alone."""
    first, mapped = _mapped_users()
    if os.geteuid() != 0 or mapped <= slot:
        return None
    if first + mapped > FIRST_USER + slot:
        return FIRST_USER + slot
    return first + mapped - 1 - slot  # in a container: the last ones that there are


def _mapped_users() -> tuple[int, int]:
    """Return the first of the longest range of users of this user namespace, and its length."""
    ranges = [line.split() for line in Path('/proc/self/uid_map').read_text().splitlines()]
    first, _, count = max(ranges, key=lambda each: int(each[2]))
    return int(first), int(count)


def _bound(sources_by_name: dict) -> list[str]:
    options = []
    for name, source in sources_by_name.items():
        options += ['--ro-bind', str(source), f'{_SEEN}/{name}']
    return options
