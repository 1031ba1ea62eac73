"""What the student's room says of a program, as a part of a sentence."""

from collections.abc import Mapping
from typing import Any

from my_robot_basics.exchange.endings import error_in, signal_name
from my_robot_basics.feedback.errors import shorten
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.feedback.python_errors import what_to_do


def text_in(told: Mapping[str, Any], key: str) -> str:
    """A text that the student's room has sent; '' where it is none."""
    text = told.get(key)
    return text if isinstance(text, str) else ''


def how(code: int | None) -> str:
    """How a program has ended, by its exit code."""
    if code is None:
        return 'it runs'
    return f'exit code {code}' if code >= 0 else f'ended by {signal_name(-code)}'


def has_ended(code: int | None, said: str) -> str:
    """That a program has ended, how, and its last words."""
    last = last_words(said)
    return f'it has ended: {how(code)}, {last}' if last else f'it has ended: {how(code)}'


def last_words(said: str) -> str:
    """The error in what was printed, or its last line; '' where nothing was."""
    lines = [line for line in said.splitlines() if line.strip()]
    last = error_in(lines) or next(reversed(lines), '')
    return f'{theirs(shorten(last))}{what_to_do(last)}' if last else ''
