"""The one exception of a failing check, and the two functions that raise it."""

import sys
from collections.abc import Callable
from functools import partial
from typing import NoReturn

import numpy as np

from my_robot_basics.drawing.described import described
from my_robot_basics.feedback import hidden
from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.session.errors import in_lines

MOST_CHARACTERS = 200


class CheckFailed(AssertionError):
    """A check's verdict in one readable sentence: what was expected, seen, and what to try."""

    repeat: Callable[[], NoReturn] | None = None
    """Fails for the same reason in another check; None where `fail` did not raise it."""

    def _render_traceback_(self) -> list[str]:
        # IPython asks for this: the sentence alone, never the source of a test.
        return in_lines(in_language_here(str(self)))


class PartlyRight(CheckFailed):
    """A verdict that leaves some of the points: the grader is told how many."""


class Starved(CheckFailed):
    """A verdict for which a machine that is too busy may be to blame: rooms take a second look."""


class Disturbed(CheckFailed):
    """One for which the check itself may be to blame: rooms take another look at it."""


def expect(
    condition: bool,
    *,
    expected: object,
    seen: object,
    hint: str,
    cause: str = '',
    doubt: type[CheckFailed] = CheckFailed,
) -> None:
    """Raise CheckFailed('expected …, saw …: hint') unless the condition holds; see `fail`.

    `hint` says what to try next, as a clause: 'convert both angles with radians()'.

    The condition is a bool; anything else is a mistake in the check and raises TypeError.
    """
    if not isinstance(condition, bool | np.bool_):
        raise TypeError(f'expect() takes a bool as its condition, not {condition!r}')
    if not condition:
        fail(expected=expected, seen=seen, hint=hint, cause=cause, doubt=doubt)


def fail(
    *,
    expected: object,
    seen: object,
    hint: str,
    cause: str = '',
    picture: bytes | None = None,
    earned: float = 0.0,
    doubt: type[CheckFailed] = CheckFailed,
) -> NoReturn:
    """Raise CheckFailed('expected …, saw …: hint'); show the picture (PNG bytes) before it.

    From a hidden part on, students read 'cause: hint' alone, or the hint: `cause` is what went
    wrong in words that tell no input, no right value, and nothing that the student's code made.
    What is `earned` all the same, fewer points than the check has, makes it a PartlyRight; where
    another than the answer may be to blame, `doubt` is Starved or Disturbed.
    """
    Failure = PartlyRight if earned else doubt
    if earned:
        hidden.tell_points(earned)
    sentence = hidden.in_full(f'expected {expected}, saw {seen}: {hint}')
    if hidden.is_quiet():
        hidden.tell_grader(sentence)
        why = hidden.without_inputs(f'{cause}: {hint}' if cause else hint)
        sentence = f'{hidden.PLACE}{why}'
    else:
        hidden.tell_hint(hidden.in_full(hint))
        if picture is not None:
            show(picture, alt=f'Picture of what was seen: {seen}')
    failure = Failure(sentence)
    failure.repeat = partial(fail, expected=expected, seen=seen, hint=hint, cause=cause)
    raise failure


def shorten(text: object, most: int = MOST_CHARACTERS) -> str:
    """One printable line of at most `most` characters, for a text that a student's code made."""
    line = ' '.join(str(text).split())
    line = ''.join(character if character.isprintable() else '?' for character in line)
    return line if len(line) <= most else line[: most - 1] + '…'


def show(picture: bytes, *, alt: str) -> None:
    """Display a PNG in the notebook, with its text alternative; nothing happens outside of one."""
    if 'IPython' not in sys.modules:
        return
    from IPython import get_ipython
    from IPython.display import display

    if get_ipython() is not None:
        bundle, metadata = described(picture, alt)
        display(bundle, metadata=metadata, raw=True)
