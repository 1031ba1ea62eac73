"""How a program has ended: its exit code, its signal, and the error in what it printed."""

import signal
from collections.abc import Sequence

RACE = 'rcl_shutdown already called'
"""Of rclpy, not of a student: its own handler of SIGINT shuts the context down in a thread, and
`try_shutdown` in main may come between. Seen in 1 of 44 ends of a plain node."""
TRY_SHUTDOWN = 'try_shutdown'
"""In a traceback, the name of the call."""


def is_clean(code: int | None, lines: Sequence[str], *, is_second: bool = False) -> bool:
    """Whether a program that was told to end did so as it should: with exit code 0.

    `is_second`: it has ended by the race before. A second time, only a program that calls
    `try_shutdown` is excused: one `shutdown` too many raises the same error each time.
    """
    is_luck = not is_second or any(TRY_SHUTDOWN in line for line in lines)
    return code == 0 or (code == 1 and RACE in error_in(lines) and is_luck)


def error_in(lines: Sequence[str]) -> str:
    """The last line of a traceback among the lines that a program has printed; '' without one."""
    starts = [i for i, line in enumerate(lines) if line.startswith('Traceback (most recent call')]
    if not starts:
        return ''
    errors = (line for line in lines[starts[-1] + 1 :] if line[:1].isalpha())
    return next(errors, 'a traceback')


def why_crashed(code: int | None) -> str:
    """What a program that Linux has ended for a wrong access to memory may have done; or ''."""
    if code != -signal.SIGSEGV:
        return ''
    return (
        'rclpy crashes like this if an ActionClient or ActionServer gets a type that is not an '
        'action, so look at each, and give it one such as MoveArm, and no part of it'
    )


def signal_name(number: int) -> str:
    """What a signal is called: SIGINT, say."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f'signal {number}'
