"""The commands that build a sandbox: the holder's, and those of its rooms."""

import os
import sys
from pathlib import Path

from grader.sandbox.bind_mounts import bind_mount_options, mount_sources
from grader.sandbox.limits import (
    OUT_OF_MEMORY_SCORE,
    ROOM_DISK_BYTES,
    ROOM_FILES,
    ROOM_TERMINALS,
    prlimit_command,
)

ROOMS = ('student', 'test')
INSIDE = Path('/room')
"""The folder inside a room that contains the room's own files."""
FIRST_USER = 1_879_048_192
"""The lowest user ID for slots: systemd's list of ID ranges leaves those from here on unused."""
KEEPER = ['sh', '-c', "trap '' CHLD; echo; exec sleep infinity >/dev/null 2>&1"]
"""Keeps a room open: prints an empty line when it is built, and leaves no orphan a zombie."""

_SEEN, DISKS = '/tmp/seen', '/tmp/disks'
"""Where the holder mounts what rooms see of the machine, and the disks that they write to."""
_TERMINALS = f'newinstance,ptmxmode=0666,mode=620,max={ROOM_TERMINALS}'
_HOLD = f"""
for room in {' '.join(ROOMS)}; do
    mount -t tmpfs -o size={ROOM_DISK_BYTES},nr_inodes={ROOM_FILES} room {DISKS}/$room || exit 1
    (cd {DISKS}/$room && mkdir -p kernel home/work tmp shm pts) || exit 1
    mount -t devpts -o {_TERMINALS} room {DISKS}/$room/pts || exit 1
done
echo $$
exec cat
"""
ENVIRONMENT = {
    'HOME': f'{INSIDE}/home',
    'PATH': f'{sys.prefix}/bin:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin',
    'AMENT_PREFIX_PATH': sys.prefix,
    'MPLCONFIGDIR': f'{INSIDE}/home/matplotlib',
    # shared memory of one room is not visible in the other
    'FASTDDS_BUILTIN_TRANSPORTS': 'UDPv4',
    # LOCALHOST would use shared memory again; the network is private to this submission anyway
    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET',
    # the limits count memory that a process asks for, used or not
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
ACCOUNTS = {'passwd': _USER, 'group': 'student:x:1000:\n', 'hosts': '127.0.0.1 localhost room\n'}


def holder_command(user: int | None, given: dict[str, Path]) -> list[str]:
    """Return the holder's command: it prints its process ID when network and disks are ready.

    `given` has the folder that each room is shown. The holder ends when its standard input closes.
    """
    seen = [
        '--tmpfs', '/tmp', '--dir', _SEEN,
        *_bound(dict(enumerate(mount_sources()))),
        *_bound(given),
        '--dir', DISKS,
    ]  # fmt: skip
    disks = ['--tmpfs', DISKS]
    for room in ROOMS:
        disks += ['--dir', f'{DISKS}/{room}']
    hold = [*disks, *_NETWORK, '--', 'sh', '-c', _HOLD]
    if user is None:
        return [*_MACHINE, *seen, *hold]
    # root first mounts what a slot's user can't reach, then becomes that user
    become = ['--cap-add', 'CAP_SETUID', '--cap-add', 'CAP_SETGID', '--', *_drop(user)]
    return [*_MACHINE, *seen, *become, *_MACHINE, *hold]


def room_command(
    user: int | None,
    *,
    holder: int,
    room: str,
    seccomp: int,
    info_fd: int | None = None,
    counted: bool = True,
) -> list[str]:
    """Return the beginning of a command that runs in a room.

    `holder` is the holder's process ID, `seccomp` the file descriptor of a filter. With an
    `info_fd`, the command is the room's first process, and its ID is written there. Unless a
    cgroup counts the room's memory (`counted`), there is no /dev/zero: mapping it shares memory.
    """
    first = [] if info_fd is None else ['--as-pid-1', '--info-fd', str(info_fd)]
    disk = f'{DISKS}/{room}'
    accounts = []
    for name in ACCOUNTS:
        accounts += ['--symlink', f'{INSIDE}/given/{name}', f'/etc/{name}']
    enter = ['nsenter', '--target', str(holder), '--user', '--net', '--mount']
    return [
        # set before the room: /proc is read-only there, so student code can't change it back
        'choom', '-n', str(OUT_OF_MEMORY_SCORE), '--',
        *_drop(user),
        *enter, '--preserve-credentials', '--',
        'bwrap', *_ROOM, *first,
        '--proc', '/proc',
        '--dev', '/dev', *([] if counted else ['--dev-bind', '/dev/null', '/dev/zero']),
        '--dev-bind', f'{disk}/pts', '/dev/pts',
        '--bind', f'{disk}/shm', '/dev/shm',
        '--bind', f'{disk}/tmp', '/tmp',
        '--bind', f'{disk}/kernel', f'{INSIDE}/kernel',
        '--bind', f'{disk}/home', f'{INSIDE}/home',
        '--ro-bind', f'{_SEEN}/{room}', f'{INSIDE}/given',
        *bind_mount_options(_SEEN, configuration=ENVIRONMENT['MPLCONFIGDIR']),
        *accounts,
        '--remount-ro', '/proc',
        '--remount-ro', '/dev',
        '--remount-ro', '/',
        '--chdir', f'{INSIDE}/home/work',
        '--unsetenv', 'JPY_PARENT_PID',  # a kernel that can't find this parent would exit
        '--seccomp', str(seccomp),
        '--', *prlimit_command(),
    ]  # fmt: skip


def _drop(user: int | None) -> list[str]:
    if user is None:
        return []
    return f'setpriv --reuid {user} --regid {user} --clear-groups --'.split()


def slot_user(slot: int) -> int | None:
    """Return the user ID that root takes for a slot; None if not root, or if it has no others."""
    first, mapped = _mapped_users()
    if os.geteuid() != 0 or mapped <= slot:
        return None
    if first + mapped > FIRST_USER + slot:
        return FIRST_USER + slot
    return first + mapped - 1 - slot  # in a container: count down from its last user ID


def _mapped_users() -> tuple[int, int]:
    """Return the first ID of this user namespace's longest range of user IDs, and its length."""
    ranges = [line.split() for line in Path('/proc/self/uid_map').read_text().splitlines()]
    first, _, count = max(ranges, key=lambda each: int(each[2]))
    return int(first), int(count)


def _bound(sources_by_name: dict) -> list[str]:
    options = []
    for name, source in sources_by_name.items():
        options += ['--ro-bind', str(source), f'{_SEEN}/{name}']
    return options
