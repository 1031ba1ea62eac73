"""The exceptions of a failing check, and the two functions that raise them."""

import sys
from collections.abc import Callable
from functools import partial
from typing import Any, NoReturn

import numpy as np

from my_robot_basics.drawing.described import png_output
from my_robot_basics.feedback import hidden
from my_robot_basics.language.english import split_line
from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.session.errors import in_lines

MOST_CHARACTERS = 200


class CheckFailed(AssertionError):
    """A check's verdict in one readable sentence: what was expected, what was seen, and a hint."""

    repeat: Callable[[], NoReturn] | None = None
    """Raises the same failure again in another check; None if `fail` did not raise this one."""

    def _render_traceback_(self) -> list[str]:
        # IPython calls this: it shows the sentence alone, never the source of a test.
        untouched = sys.modules.get('my_robot_basics.checks.topics.untouched')
        said = (untouched.instead_of_failure() if untouched else '') or str(self)
        return in_lines(in_language_here(said))


class PartlyRight(CheckFailed):
    """A failure that earns part of the points; `fail` tells the grader how many."""


class Starved(CheckFailed):
    """A failure that a busy machine may have caused: the check is repeated in fresh rooms."""


class Disturbed(CheckFailed):
    """A failure that the check itself may have caused: it is repeated in fresh rooms."""


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

    In a hidden part, students read only 'cause: hint', or the hint alone: `cause` says what is
    wrong without any input, expected value, or output of the student's code.
    With `earned`, the points that the answer still gets, it raises PartlyRight. If something
    other than the answer may be the reason, `doubt` is Starved or Disturbed.
    """
    Failure = PartlyRight if earned else doubt
    if earned:
        hidden.tell_points(earned)
    sentence = hidden.without_marks(f'expected {expected}, saw {seen}: {hint}')
    if hidden.is_quiet():
        hidden.tell_grader(sentence)
        why = hidden.without_inputs(f'{cause}: {hint}' if cause else hint)
        sentence = f'{hidden.PLACE}{why}'
    else:
        hidden.tell_hint(hidden.without_marks(hint))
        if picture is not None:
            show(picture, alt=f'Picture of what was seen: {seen}')
    failure = Failure(sentence)
    failure.repeat = partial(fail, expected=expected, seen=seen, hint=hint, cause=cause)
    raise failure


def cause_of(failure: CheckFailed) -> str:
    """Return the `cause` that `fail` was given for it, or ''."""
    return str(_told(failure).get('cause', ''))


def fail_with_hint(failure: CheckFailed, hint: str) -> NoReturn:
    """Raise the same failure with another hint; unchanged if `fail` did not raise it."""
    told = _told(failure)
    if not told or isinstance(failure, PartlyRight):
        raise failure
    fail(**told | {'hint': hint, 'doubt': type(failure)})


def _told(failure: CheckFailed) -> dict[str, Any]:
    """Return what `fail` was given for that failure; {} if it did not raise it."""
    return getattr(failure.repeat, 'keywords', {})


def shorten(text: object, most: int = MOST_CHARACTERS) -> str:
    """Return a text of a student's code as one printable line of at most `most` characters."""
    line = ' '.join(str(text).split())
    line = ''.join(character if character.isprintable() else '?' for character in line)
    return line if len(line) <= most else line[: most - 1] + '…'


def shorten_exception(said: str) -> str:
    """Shorten an exception's text, and keep the line where it was raised, if it names one."""
    what, where = split_line(' '.join(said.split()))
    if not where:
        return shorten(what)
    where = shorten(where, MOST_CHARACTERS // 2)
    return f'{shorten(what, MOST_CHARACTERS - len(where) - len(" ()"))} ({where})'


def show(picture: bytes, *, alt: str) -> None:
    """Display a PNG with its alternative text in a notebook; outside of one, do nothing."""
    if 'IPython' not in sys.modules:
        return
    from IPython import get_ipython
    from IPython.display import display

    if get_ipython() is not None:
        bundle, metadata = png_output(picture, alt)
        display(bundle, metadata=metadata, raw=True)
