"""How a kernel ended, and who can be shown to have caused it."""

import resource
import signal
from dataclasses import dataclass
from enum import Enum, auto

from my_robot_basics.exchange.endings import signal_name

from grader.sandbox.cgroups import MemoryEvents
from grader.sandbox.limits import PROCESS_LIMITS, ROOM_MEMORY_BYTES

_CRASHES = {'SIGSEGV', 'SIGBUS', 'SIGILL', 'SIGFPE', 'SIGABRT', 'SIGSYS', 'SIGTRAP', 'SIGXFSZ'}
"""What Linux sends a process for what that did itself."""
_OWN = {'SIGALRM', 'SIGVTALRM', 'SIGPROF', 'SIGIO', 'SIGPIPE', 'SIGXCPU'}
"""What Linux sends a process that has set a timer, or uses a file or a processor so."""
_TERMINALS = {'SIGHUP', 'SIGINT', 'SIGQUIT'}
"""What Linux sends to a process whose terminal is closed, or where such keys come."""


class Responsibility(Enum):
    """Who is responsible for the end of a kernel."""

    STUDENTS = auto()
    """Their code did it."""
    DOUBTFUL = auto()
    """Their code seems to have done it: it would do it again."""
    NOT_SHOWN = auto()
    """Nothing shows that their code did it."""


@dataclass(frozen=True)
class Ending:
    """How a kernel ended, as far as its parent and its room know."""

    signal: int | None = None
    """What ended it: 0 where it exited, None where nobody knows."""
    sent: bool = False
    """Whether somebody in its room sent that signal to it, or may have."""
    cpu_sec: float = 0.0
    """The time that it kept a processor busy."""

    def whose(self, memory: MemoryEvents) -> tuple[Responsibility, str]:
        """Return who is responsible, and what to say of it; '' for an ordinary exit."""
        if self.signal is None:
            return Responsibility.NOT_SHOWN, 'nobody knows how it ended'
        if self.signal == 0:
            return Responsibility.STUDENTS, ''
        name = signal_name(self.signal)
        if self.sent:
            return Responsibility.STUDENTS, f'your code sent it {name}'
        if self.signal == signal.SIGKILL and memory.killed:
            return whose_memory(memory)
        if self.cpu_sec >= (most := PROCESS_LIMITS[resource.RLIMIT_CPU]):
            return Responsibility.STUDENTS, f'it kept a processor busy for more than {most} s'
        if name in _CRASHES:
            return Responsibility.DOUBTFUL, f'it crashed with {name}'
        if name in _OWN:
            return (
                Responsibility.DOUBTFUL,
                f'{name} ended it, a signal that Linux sends because of what a process did',
            )
        return (
            Responsibility.NOT_SHOWN,
            f'{name} ended it, and no process in its room had sent that signal',
        )


def whose_memory(memory: MemoryEvents) -> tuple[Responsibility, str]:
    """Return who is responsible where a process was ended for want of memory, and what to say."""
    if memory.limit_reached:
        return (
            Responsibility.DOUBTFUL,
            f'your code used more than {ROOM_MEMORY_BYTES / 2**20:,.0f} MB',
        )
    return Responsibility.NOT_SHOWN, 'Linux ended it, because memory ran out outside of its room'


def is_from_outside(number: int) -> bool:
    """Whether a signal is none that Linux sends a program for what it, or its terminal, did."""
    return signal_name(number) not in _CRASHES | _OWN | _TERMINALS
