"""Run a command, and end whatever it leaves running: `python -I -S subreaper.py COMMAND …`.

When the parent of a process ends, the nearest subreaper above becomes its new parent. So the
orphans of the command become children of this process, whatever session, group or environment
they have chosen. The exit code is the command's, or 128 + N if signal N ended it.
"""

import ctypes
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path

LOOK_EVERY_SEC = 0.5
"""How often to look for orphans."""
ROUNDS_MOST = 1_000
"""How often orphans are killed before giving up: they may start others faster than that."""
_PR_SET_CHILD_SUBREAPER = 36
_WAKES = (signal.SIGTERM, signal.SIGINT, signal.SIGCHLD)


def run(command: list[str]) -> int:
    """Run a command and return its exit code; SIGTERM and SIGINT end all that it has started.

    Raises OSError if there is no such command.
    """
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    signal.pthread_sigmask(signal.SIG_BLOCK, _WAKES)
    pid = os.posix_spawnp(command[0], command, os.environ, setsigmask=[])
    status = None
    while status is None:
        woken = signal.sigtimedwait(_WAKES, LOOK_EVERY_SEC)
        if woken and woken.si_signo != signal.SIGCHLD:
            break
        status = _reap().get(pid)
        _end_children(but=pid if status is None else None)
    for _ in range(ROUNDS_MOST):
        if not _end_children():
            break
        signal.sigtimedwait(_WAKES, 0.01)
        _reap()
    code = os.waitstatus_to_exitcode(status) if status is not None else -signal.SIGTERM
    return code if code >= 0 else 128 - code


def _reap() -> dict[int, int]:
    """Reap the children that have ended; return their wait statuses by process ID."""
    ended: dict[int, int] = {}
    with suppress(ChildProcessError):
        while (child := os.waitpid(-1, os.WNOHANG))[0]:
            ended |= [child]
    return ended


def _end_children(but: int | None = None) -> bool:
    """Kill the children, except `but`; return whether there were any."""
    children = [child for child in _children() if child != but]
    for child in children:
        with suppress(ProcessLookupError, PermissionError):
            os.kill(child, signal.SIGKILL)
    return bool(children)


def _children() -> list[int]:
    found: list[int] = []
    for process in Path('/proc').glob('[0-9]*'):
        with suppress(OSError):
            stat = (process / 'stat').read_text(encoding='utf-8', errors='replace')
            # after the name, which may contain anything: the state, and the parent's process ID
            if int(stat.rpartition(')')[2].split()[1]) == os.getpid():
                found.append(int(process.name))
    return found


if __name__ == '__main__':
    sys.exit(run(sys.argv[1:]))
