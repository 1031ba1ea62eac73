"""The part of a check that students are not given: what fails there is told by its cause alone.

The grader runs a grade cell as `marked` of `hidden_source` writes it. From its hidden part on,
`fail` names neither inputs nor what is right, and nothing that the student's code made: someone
who builds a table from feedback has nothing to write into it. The whole sentence goes to the
instructor.
"""

import builtins
import os
import re
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

PLACE = 'in the part checked at grading: '
"""How a reason from there begins."""

MOST_DETAILS = 2_000
"""Characters; what a student's code returned may be long."""

_MARK = 'application/vnd.my_robot_basics.hidden'
"""A display of this MIME type is for the grader: that the hidden part began, or that inputs were
chosen. …"""
_DETAILS = 'application/vnd.my_robot_basics.details'
"""… Of this one, too: the sentence that a student is not told. …"""
_POINTS = 'application/vnd.my_robot_basics.points'
"""… Of this one: the points that a check leaves which fails. …"""
_HINT = 'application/vnd.my_robot_basics.hint'
"""… And of this one: which words of its sentence say what to try."""
_BEGAN, _INPUTS, _ALREADY = 'began', 'inputs', 'already'

_OPEN, _CLOSE = '\u2068', '\u2069'
"""Around what a student's code made."""
_THEIRS = re.compile(f'{_OPEN}[^{_CLOSE}]*{_CLOSE}')
_MEASURED = re.compile(r'(?<![\w.])[-+−]?(\d+\.\d+|\d{3,})(?![\w.]*\d)°?')
_LIST = re.compile(r'…(, …)+')

_quiet = False
_start_sec: float | None = None


def is_in_test_room() -> bool:
    """Whether the grader runs this check, in a room apart from the notebook's."""
    return os.environ.get('MY_ROBOT_BASICS_ROOM') == 'test'


def is_advice() -> bool:
    """Whether *Validate* runs this check: what it says costs nobody points."""
    return os.environ.get('MY_ROBOT_BASICS_ADVICE') == '1'


def start(*, quiet: bool) -> None:
    """Begin a grade cell."""
    global _quiet, _start_sec
    _quiet = quiet
    _start_sec = time.monotonic() if _start_sec is None else _start_sec


def checked_for_sec() -> float:
    """For how long *Validate* has checked these nodes already; 0 where the grader does.

    What has not come in that time is not waited for once more. The grader takes nobody's word
    that a callback would not have made it later.
    """
    return time.monotonic() - _start_sec if is_advice() and _start_sec is not None else 0.0


def begin() -> None:
    """Begin its hidden part, which goes on to the cell's end."""
    global _quiet
    _quiet = True
    _display(_MARK, _BEGAN)


def tell_failed_already() -> None:
    """Let the grader know that a failure which is told at the end is of the visible part, too."""
    if is_in_test_room():
        _display(_MARK, _ALREADY)


def is_quiet() -> bool:
    """Whether a failure is told by its cause alone."""
    return _quiet


def note_inputs() -> None:
    """Let the grader know that the check has chosen inputs."""
    if is_in_test_room():
        _display(_MARK, _INPUTS)


def theirs(text: object) -> str:
    """What a student's code made, for a sentence: nobody is told it from the hidden part."""
    said = in_full(str(text))  # a name that DDS brings may hold any character
    return f'{_OPEN}{said}{_CLOSE}' if _quiet else said


def raised(said: str) -> str:
    """`said`, like "ValueError: …", where the name of an exception of Python's own is nobody's."""
    kind, _, message = said.partition(':')
    if not isinstance(getattr(builtins, kind, None), type):
        return theirs(said)
    return f'{kind}: {theirs(message.strip())}' if message else kind


def in_full(text: str) -> str:
    """A sentence for readers who may read all of it."""
    return text.replace(_OPEN, '').replace(_CLOSE, '')


def without_inputs(text: str) -> str:
    """A sentence without what the student's code made, and without measured numbers."""
    return _LIST.sub('…', _MEASURED.sub('…', _THEIRS.sub('…', text)))


def tell_grader(details: str) -> None:
    """Hand over what an instructor may read of a failure."""
    _display(_DETAILS, details)


def tell_points(earned: float) -> None:
    """Hand over how many points a check that fails leaves."""
    if is_in_test_room():
        _display(_POINTS, repr(float(earned)))


def points_in(outputs: Iterable[Any]) -> float:
    """How many points were handed over; 0 where none were."""
    return float(next(iter(_said(outputs, _POINTS)), 0.0))


def tell_hint(hint: str) -> None:
    """Hand over which words at the end of a sentence say what to try."""
    if is_in_test_room():
        _display(_HINT, hint)


def hint_in(outputs: Iterable[Any], reason: str) -> str:
    """The words at a reason's end that were handed over, or ''."""
    return next((said for said in _said(outputs, _HINT) if reason.endswith(f': {said}')), '')


@contextmanager
def said_in_full() -> Iterator[None]:
    """For what a check says of a student's work without a word of any hidden input."""
    global _quiet
    former, _quiet = _quiet, False
    try:
        yield
    finally:
        _quiet = former


def has_started(outputs: Iterable[Any]) -> bool:
    """Whether a cell with these outputs came to its hidden part."""
    return _BEGAN in _said(outputs, _MARK)


def failed_only_there(outputs: Iterable[Any]) -> bool:
    """Whether a check that failed did so in its hidden part, and not before it."""
    said = _said(outputs, _MARK)
    return _BEGAN in said and _ALREADY not in said


def has_told_inputs(outputs: Iterable[Any]) -> bool:
    """Whether it came there with inputs of its own: the student's code knows them now."""
    said = _said(outputs, _MARK)
    return _BEGAN in said and _INPUTS in said


def details_in(outputs: Iterable[Any]) -> str:
    """What was handed over to the grader, or ''."""
    return next(iter(_said(outputs, _DETAILS)), '')[:MOST_DETAILS]


def shown(outputs: Sequence[Any]) -> list[Any]:
    """The outputs from before the hidden part, without what was for the grader."""
    kept = []
    for output in outputs:
        if _BEGAN in _said([output], _MARK):
            break
        if not _is_for_the_grader(output):
            kept.append(output)
    return kept


def _said(outputs: Iterable[Any], mime: str) -> list[str]:
    return [out['data'][mime] for out in outputs if mime in (out.get('data') or ())]


def _is_for_the_grader(output: Any) -> bool:
    return bool({_MARK, _DETAILS, _POINTS, _HINT} & {*(output.get('data') or ())})


def _display(mime: str, text: str) -> None:
    from IPython.display import display

    display({mime: text}, raw=True)
