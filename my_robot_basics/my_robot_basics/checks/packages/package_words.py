"""What the student's room reports about a program, as a part of a sentence."""

import re
from collections.abc import Mapping
from typing import Any

from my_robot_basics.exchange.endings import error_in, signal_name, why_code, why_crashed
from my_robot_basics.feedback.errors import shorten
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.feedback.python_errors import hint_for_exception

_NO_CAUSE = re.compile('RuntimeWarning: Enable tracemalloc')
"""Python prints this below the warning about a coroutine that nobody awaits."""
_OWN_ERROR = re.compile('(?:Attribute|Name|UnboundLocal|Type|Key|Index|ZeroDivision)Error')
"""Errors that mistakes in a program raise, and Ctrl-C by itself does not."""
CLEANLY = (
    'in main, catch KeyboardInterrupt and ExternalShutdownException around all that waits, such '
    'as rclpy.spin, and call rclpy.try_shutdown() at the end'
)


def text_in(told: Mapping[str, Any], key: str) -> str:
    """The text under that key in the student's room's answer, or '' if there is no text."""
    text = told.get(key)
    return text if isinstance(text, str) else ''


def describe_exit(exit_code: int | None) -> str:
    """How a program has ended, according to its exit code."""
    if exit_code is None:
        return 'it runs'
    return f'exit code {exit_code}' if exit_code >= 0 else f'ended by {signal_name(-exit_code)}'


def describe_end(code: int | None, said: str) -> str:
    """A clause that says how a program has ended and what it printed last."""
    last = last_words(said)
    end = describe_exit(code)
    return f'it has ended: {end}, {last}' if last else f'it has ended: {end}'


def last_words(said: str) -> str:
    """The error in a program's output, or its last line; '' if there was no output."""
    lines = [line for line in said.splitlines() if line.strip() and not _NO_CAUSE.match(line)]
    last = error_in(lines) or next(reversed(lines), '')
    return f'{student_text(shorten(last))}{hint_for_exception(last)}' if last else ''


def why_ended(code: int | None, package: str, executable: str) -> str:
    """Advice about a program that ended although it should run on."""
    if code == 0:
        return 'main has returned: let it spin the node until Ctrl-C'
    run_it = f"run it with run_executable('{package}', '{executable}') and read why"
    return why_crashed(code) or run_it


def why_not_clean(code: int | None, said: str) -> str:
    """Advice about a program that ended after Ctrl-C, but with an error."""
    if why := why_crashed(code, at_end=True):
        return why
    if _OWN_ERROR.match(error_in(said.splitlines())):
        return (
            'correct this error first; if it comes only after Ctrl-C, which ends a wait for a '
            'future, look at future.done() before you use its result'
        )
    return why_code(code, said.splitlines()) or CLEANLY


def why_it_goes_on(told: Mapping[str, Any]) -> str:
    """Advice about a program that goes on after Ctrl-C; `told` is the room's on its code."""
    if told.get('own') is True:
        return (
            'leave SIGINT to rclpy.init(), without signal.signal and signal_handler_options: '
            'while rclpy.spin waits, no handler of your own is called'
        )
    if told.get('calls') is True:
        return (
            'client.call(…) waits for a response, and after Ctrl-C none comes: use call_async, '
            'and `await future` in a callback, or rclpy.spin_until_future_complete in main'
        )
    return 'let no callback and no loop go on for long, and do not catch KeyboardInterrupt there'
