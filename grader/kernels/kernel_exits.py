"""How a kernel ended, and whether the student's code is known to have caused it."""

import resource
import signal
from dataclasses import dataclass
from enum import Enum, auto

from my_robot_basics.exchange.endings import signal_name

from grader.sandbox.cgroups import MemoryEvents
from grader.sandbox.limits import PROCESS_LIMITS, ROOM_MEMORY_BYTES

_CRASHES = {'SIGSEGV', 'SIGBUS', 'SIGILL', 'SIGFPE', 'SIGABRT', 'SIGSYS', 'SIGTRAP', 'SIGXFSZ'}
"""Signals that Linux sends to a process because of the process's own fault."""
_OWN = {'SIGALRM', 'SIGVTALRM', 'SIGPROF', 'SIGIO', 'SIGPIPE', 'SIGXCPU'}
"""Signals that Linux sends for a timer that a process set, or for its use of a file or CPU."""
_TERMINALS = {'SIGHUP', 'SIGINT', 'SIGQUIT'}
"""Signals that Linux sends when a terminal closes, or when Ctrl-C or Ctrl-\\ is pressed there."""


class Responsibility(Enum):
    """Who is responsible for the end of a kernel."""

    STUDENTS = auto()
    """The student's code caused it."""
    DOUBTFUL = auto()
    """The student's code seems to have caused it: if so, it will do it again."""
    NOT_SHOWN = auto()
    """Nothing shows that the student's code caused it."""


@dataclass(frozen=True)
class Ending:
    """How a kernel ended, as far as its parent process and its room can tell."""

    signal: int | None = None
    """The signal that ended it; 0 if it exited, None if that is unknown."""
    sent: bool = False
    """Whether a process in its room sent that signal to it, or may have sent it."""
    cpu_sec: float = 0.0
    """Seconds of processor time that the kernel used."""

    @property
    def crash(self) -> str:
        """The signal of a crash, such as SIGSEGV; '' if it ended otherwise."""
        name = signal_name(self.signal) if self.signal and not self.sent else ''
        return name if name in _CRASHES else ''

    def responsibility(self, memory: MemoryEvents) -> tuple[Responsibility, str]:
        """Return who is responsible, and the reason as text; '' for an ordinary exit."""
        if self.signal is None:
            return Responsibility.NOT_SHOWN, 'how it ended is unknown'
        if self.signal == 0:
            return Responsibility.STUDENTS, ''
        name = signal_name(self.signal)
        if self.sent:
            return Responsibility.STUDENTS, f'your code sent it {name}'
        if self.signal == signal.SIGKILL and memory.killed:
            return responsible_for_memory(memory)
        if self.cpu_sec >= (most := PROCESS_LIMITS[resource.RLIMIT_CPU]):
            return Responsibility.STUDENTS, f'it kept a processor busy for more than {most} s'
        if name in _CRASHES:
            return Responsibility.DOUBTFUL, f'it crashed with {name}'
        if name in _OWN:
            return (
                Responsibility.DOUBTFUL,
                f'{name} ended it: Linux sends this signal because of something that the process '
                'did, such as set a timer',
            )
        return (
            Responsibility.NOT_SHOWN,
            f'{name} ended it, but no process in its room sent that signal',
        )


def responsible_for_memory(memory: MemoryEvents) -> tuple[Responsibility, str]:
    """Return who is responsible if Linux killed a process for lack of memory, and the reason."""
    if memory.limit_reached:
        return (
            Responsibility.DOUBTFUL,
            f'your code used more than {ROOM_MEMORY_BYTES / 2**20:,.0f} MB',
        )
    return (
        Responsibility.NOT_SHOWN,
        'Linux ended it because the machine ran out of memory; its room was within its own limit',
    )


def is_from_outside(number: int) -> bool:
    """Whether this is not a signal that Linux sends because of a program or its terminal."""
    return signal_name(number) not in _CRASHES | _OWN | _TERMINALS
