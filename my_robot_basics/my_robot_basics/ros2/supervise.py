"""Run an executable as a child that gets every signal once; this process ends with it.

The child has a process group of its own: else a signal to the whole group (Ctrl-C, or `timeout`)
would reach it twice, directly and forwarded by this process. At a terminal, its group becomes the
foreground one: Ctrl-C, Ctrl-Z and keyboard input then go to the child.
"""

import contextlib
import ctypes
import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator

from my_robot_basics.ros2.errors import CommandError

PR_SET_PDEATHSIG = 1
"""The option of Linux's prctl that sets the signal to get when the parent ends."""
FORWARDED = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT}
BURST_SEC = 0.2
"""`timeout` signals the process and its group: in this time, each kind is forwarded once."""


def run(command: list[str]) -> int:
    """Run a command to its end, report a failure as ros2cli does, and return its exit status.

    A negative status is the signal that ended the command. Raises CommandError if it can't start.
    """
    # blocked, not handled: signals before the child exists stay pending, and _follow takes them
    signal.pthread_sigmask(signal.SIG_BLOCK, {*FORWARDED, signal.SIGCHLD})
    try:
        child = subprocess.Popen(command, process_group=0, preexec_fn=_prepare)
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise CommandError(f'`{shlex.join(command)}` does not start: {reason}') from None
    with _terminal_for(child.pid):
        status = _follow(child)
    if status < 0:
        print('[ros2run]:', signal.strsignal(-status))
    elif status > 0:
        print('[ros2run]: Process exited with failure', status)
    return status


def _prepare() -> None:
    """In the child, before exec: end with the parent, and unblock the signals."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {*FORWARDED, signal.SIGCHLD})


def _follow(child: subprocess.Popen) -> int:
    forwarded: set[int] = set()
    while True:
        pid, wait_status = os.waitpid(child.pid, os.WNOHANG | os.WUNTRACED)
        if pid and os.WIFSTOPPED(wait_status):
            _stop_too(child.pid)
        elif pid:
            # tell Popen, which must not wait for it again
            child.returncode = os.waitstatus_to_exitcode(wait_status)
            return child.returncode
        elif info := _next_signal(BURST_SEC if forwarded else None):
            if info.si_signo in FORWARDED - forwarded:
                forwarded.add(info.si_signo)
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(child.pid, info.si_signo)
        else:
            forwarded.clear()


def _next_signal(timeout_sec: float | None) -> signal.struct_siginfo | None:
    awaited = {*FORWARDED, signal.SIGCHLD}
    if timeout_sec is None:
        return signal.sigwaitinfo(awaited)
    return signal.sigtimedwait(awaited, timeout_sec)


def _stop_too(pid: int) -> None:
    """Stop this process because the child has stopped (Ctrl-Z), and later continue both."""
    terminal = _own_terminal()
    if terminal is not None and os.tcgetpgrp(terminal) == pid:
        os.tcsetpgrp(terminal, os.getpgrp())
    os.kill(os.getpid(), signal.SIGSTOP)
    if terminal is not None and os.tcgetpgrp(terminal) == os.getpgrp():
        os.tcsetpgrp(terminal, pid)
    os.killpg(pid, signal.SIGCONT)


@contextlib.contextmanager
def _terminal_for(pid: int) -> Iterator[None]:
    """Make another process group the terminal's foreground group, if this one is, meanwhile."""
    terminal = _own_terminal()
    if terminal is None or os.tcgetpgrp(terminal) != os.getpgrp():
        yield
        return
    before = signal.signal(signal.SIGTTOU, signal.SIG_IGN)  # to take it back in the background
    os.tcsetpgrp(terminal, pid)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGCONT)  # it may have read from the terminal and been stopped
    try:
        yield
    finally:
        os.tcsetpgrp(terminal, os.getpgrp())
        signal.signal(signal.SIGTTOU, before)


def _own_terminal() -> int | None:
    """Return the descriptor of stdin if that is the terminal of this session, else None."""
    try:
        descriptor = sys.stdin.fileno()
        os.tcgetpgrp(descriptor)
    except (OSError, ValueError, AttributeError):
        return None
    return descriptor
