"""Which signals the processes of a room send: Linux reports each to us before it is sent.

A process's exit status says which signal ended it, but not who sent that signal. Inside a room,
only the student's own processes can send one to them, by a system call. A filter notifies us of
each such call, and the call goes on when we have recorded it. So if a signal ended a process, and
no process in the room sent that signal, it came from outside.
"""

import asyncio
import fcntl
import os
import re
import select
import struct
from pathlib import Path

from grader.sandbox.seccomp_notify import EXIT_GROUP, PRCTL, SENDING

EVERYONE = 0
"""Means that any process may be the target."""
_MOST = 4_096
"""If more different signals than this were recorded, any signal may have been sent."""

_RECEIVE, _SEND = 0xC0502100, 0xC0182101
"""SECCOMP_IOCTL_NOTIF_RECV and _SEND."""
_NOTIFICATION = struct.Struct('=QIIiIQ6Q')
_ANSWER = struct.Struct('=QqiI')
_CONTINUE = 1


class Signals:
    """The signals that the processes of one room have sent."""

    def __init__(self, kernel: int, listener: int = -1) -> None:
        """Take a pidfd of the kernel, which stays open, and its filter's listener, closed later.

        Without a listener (-1) nothing is known. Create it in a running event loop.
        """
        self.pid = int(_field(Path(f'/proc/self/fdinfo/{kernel}'), 'Pid'))
        """The kernel's process ID, as the grader sees it."""
        self.exit_code: int | None = None
        """The kernel's own exit code, if it is one that bubblewrap would use for a signal."""
        self._listener = listener
        self._sent: set[tuple[int, int]] = set()
        self._by_other_means = listener < 0
        self.known = listener >= 0
        self._ids = _ids(self.pid)
        if self.known:
            self._loop = asyncio.get_running_loop()
            self._loop.add_reader(listener, self._take)

    def explain(self, number: int, ids: tuple[int, int] | None = None) -> bool:
        """Return whether a process in the room sent a signal, or may have sent it.

        Its target is a process, given by its ID and its group's ID inside the room; by default the
        kernel.
        """
        pid, group = ids or self._ids
        targets = {(pid, number), (-group, number), (EVERYONE, number)}
        return self.known and (self._by_other_means or bool(targets & self._sent))

    def close(self) -> None:
        """Stop listening, and close the listener."""
        if self._listener >= 0:
            self._loop.remove_reader(self._listener)
            os.close(self._listener)
            self._listener = -1

    def _take(self) -> None:
        """Record one call, and let it continue."""
        poll = select.poll()
        poll.register(self._listener, select.POLLIN)
        if not any(event & select.POLLIN for _, event in poll.poll(0)):
            self._loop.remove_reader(self._listener)  # all processes with this filter have ended
            return
        said = bytearray(_NOTIFICATION.size)
        try:
            fcntl.ioctl(self._listener, _RECEIVE, said)
            number, sender, _, call, _, _, *arguments = _NOTIFICATION.unpack(said)
            self._note(sender, call, arguments)
            fcntl.ioctl(self._listener, _SEND, _ANSWER.pack(number, 0, 0, _CONTINUE))
        except FileNotFoundError:  # the process that called has ended meanwhile
            pass
        except OSError:  # all processes with this filter have ended
            self._loop.remove_reader(self._listener)

    def _note(self, sender: int, call: int, arguments: list[int]) -> None:
        if call == EXIT_GROUP:
            if Path(f'/proc/{self.pid}/task/{sender}').exists():
                self.exit_code = arguments[0] & 0xFF
            return
        if call not in (*SENDING, PRCTL) or len(self._sent) > _MOST:
            self._by_other_means = True
            return
        if call == PRCTL:  # the sender asks for a signal when its parent ends
            self._sent.add((_ids(sender)[0], _signed(arguments[1])))
            return
        place, signal_place = SENDING[call]
        target = EVERYONE if place is None else _signed(arguments[place])
        if target == 0:  # all of the sender's process group
            target = -_ids(sender)[1]
        self._sent.add((EVERYONE if target == -1 else target, _signed(arguments[signal_place])))


def killed_processes(kernel: int) -> list[tuple[int, tuple[int, int]]]:
    """Return the signal that ended each process below a kernel, and the IDs it had in the room.

    They are known only until the parent process waits for the child.
    """
    found: list[tuple[int, tuple[int, int]]] = []
    todo = [kernel]
    while todo:
        for pid in _children(todo.pop()):
            todo.append(pid)
            try:
                state, *_, status = _stat(pid)
                if state == 'Z' and int(status) & 0x7F:
                    found.append((int(status) & 0x7F, _ids(pid)))
            except OSError:  # it was reaped meanwhile
                continue
    return found


def _children(pid: int) -> list[int]:
    found: list[int] = []
    for path in Path(f'/proc/{pid}/task').glob('*/children'):
        try:
            found += map(int, path.read_text('ascii').split())
        except OSError:
            continue
    return found


def _stat(pid: int) -> list[str]:
    return Path(f'/proc/{pid}/stat').read_text(errors='replace').rpartition(')')[2].split()


def _ids(pid: int) -> tuple[int, int]:
    """Return a process's ID and its group's ID inside its own PID namespace."""
    status = Path(f'/proc/{pid}/status')
    try:
        return int(_field(status, 'NStgid').split()[-1]), int(_field(status, 'NSpgid').split()[-1])
    except (OSError, IndexError):  # it has ended
        return EVERYONE, EVERYONE


def _field(path: Path, name: str) -> str:
    found = re.search(rf'^{name}:\s*(.*)$', path.read_text(errors='replace'), re.MULTILINE)
    return found[1] if found else ''


def _signed(argument: int) -> int:
    return (argument & 0xFFFFFFFF) - ((argument & 0x80000000) << 1)
