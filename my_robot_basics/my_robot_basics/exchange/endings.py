"""How a program ended: its exit code, its signal, and the error in its output."""

import re
import signal
from collections.abc import Sequence

RACE = 'rcl_shutdown already called'
"""An error of rclpy, not of the student: its SIGINT handler shuts the context down in a thread,
and `try_shutdown` in main may run at the same time. Seen in 1 of 44 ends of a plain node."""
_IMPORTS = re.compile('<frozen importlib')
"""What a traceback has in each line about an import that has not ended."""
_RUNS = re.compile(', in main$')
"""What ends the line of a traceback about the program's own function."""
_ERROR = re.compile(r'[\w.]+(?:Error|Exception|Interrupt)\b')
"""How the last line of a traceback begins, whose first lines may not have been kept."""
TRY_SHUTDOWN = 'try_shutdown'
"""The name of the call, as a traceback shows it."""


def is_clean(code: int | None, lines: Sequence[str], *, is_second: bool = False) -> bool:
    """Whether a program that was told to end did so correctly: with exit code 0, or by RACE.

    `is_second`: it ended by RACE before. The second time, RACE is accepted only if the program
    calls `try_shutdown`: a superfluous `shutdown` raises the same error each time.
    """
    is_luck = not is_second or any(TRY_SHUTDOWN in line for line in lines)
    return code == 0 or (code == 1 and RACE in error_in(lines) and is_luck)


def error_in(lines: Sequence[str]) -> str:
    """Return the last line of the last traceback in a program's output; '' if it has none."""
    starts = [i for i, line in enumerate(lines) if line.startswith('Traceback (most recent call')]
    if not starts:
        return ''
    errors = (line for line in lines[starts[-1] + 1 :] if line[:1].isalpha())
    return next(errors, 'a traceback')


def why_code(code: int | None, lines: Sequence[str]) -> str:
    """Return advice about an exit code above 0 without an exception; '' for any other end."""
    if not code or code < 0 or error_in(lines) or any(map(_ERROR.match, lines)):
        return ''
    return (
        'no exception ended it, so main returns something, or calls sys.exit with it: return '
        'nothing, or 0'
    )


def was_starting(code: int | None, lines: Sequence[str]) -> bool:
    """Whether SIGINT has ended a program before its code ran, or while it imported modules.

    Once its code runs, Python shows in a traceback where KeyboardInterrupt was raised.
    """
    if code != -signal.SIGINT or not lines:
        return code == -signal.SIGINT
    imports = any(map(_IMPORTS.search, lines))
    runs = any(map(_RUNS.search, lines))
    return imports and not runs and error_in(lines).startswith('KeyboardInterrupt')


def why_crashed(code: int | None, *, at_end: bool = False) -> str:
    """Return the probable mistake in a program that crashed inside rclpy; '' for other codes.

    `at_end`: it ran until it was told to end.
    """
    if at_end and code in (-signal.SIGSEGV, -signal.SIGABRT):
        # Python 3.11 takes a thread for ended if Ctrl-C interrupts its join(): a later one returns
        return (
            'rclpy can crash like this if main returns while a thread still spins, so spin in '
            'main, and let the thread do the rest; or wait for each thread with join(), but only '
            'after rclpy.try_shutdown()'
        )
    if code != -signal.SIGSEGV:
        return ''
    return (
        'rclpy crashes like this if an ActionClient or ActionServer gets a type that is not an '
        'action, so look at each, and give it one such as MoveArm, and no part of it'
    )


def signal_name(number: int) -> str:
    """Return the name of a signal, such as SIGINT."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f'signal {number}'
