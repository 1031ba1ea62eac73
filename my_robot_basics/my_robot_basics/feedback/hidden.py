"""The hidden part of a check, which is not released: students read only the cause of its failure.

The grader runs a grade cell as `mark_hidden_part` of `hidden_source` writes it. In the hidden
part, `fail` names neither inputs nor expected values, and no output of the student's code: so
nobody can collect the right answers from feedback into a lookup table. The whole sentence goes to
the instructor.
"""

import builtins
import os
import re
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

PLACE = 'in the part checked at grading: '
"""How the reason of a failure in the hidden part begins."""

MOST_DETAILS = 2_000
"""Characters that are kept of a sentence for the instructor: returned values may be long."""

_MARK = 'application/vnd.my_robot_basics.hidden'
"""MIME type of a display for the grader: the hidden part began, inputs were chosen, or a failure
occurred in the visible part, too."""
_DETAILS = 'application/vnd.my_robot_basics.details'
"""MIME type of a display for the grader: the full sentence, which students may not read."""
_POINTS = 'application/vnd.my_robot_basics.points'
"""MIME type of a display for the grader: the points that a failed check still gives."""
_HINT = 'application/vnd.my_robot_basics.hint'
"""MIME type of a display for the grader: which words at the end of a reason are the hint."""
_BEGAN, _INPUTS, _ALREADY = 'began', 'inputs', 'already'

_OPEN, _CLOSE = '\u2068', '\u2069'
"""Characters around a text that the student's code made."""
_THEIRS = re.compile(f'{_OPEN}[^{_CLOSE}]*{_CLOSE}')
_MEASURED = re.compile(r'(?<![\w.])[-+−]?(\d+\.\d+|\d{3,})(?![\w.]*\d)°?')
_LIST = re.compile(r'…(, …)+')

_quiet = False
_start_sec: float | None = None


def is_in_test_room() -> bool:
    """Whether the grader runs this check, in a room apart from the notebook's."""
    return os.environ.get('MY_ROBOT_BASICS_ROOM') == 'test'


def is_validating() -> bool:
    """Whether *Validate* runs this check, so that its result costs no points."""
    return os.environ.get('MY_ROBOT_BASICS_ADVICE') == '1'


def start_cell(*, quiet: bool) -> None:
    """Begin a grade cell; with `quiet`, it is treated as hidden from its first line."""
    global _quiet, _start_sec
    _quiet = quiet
    _start_sec = time.monotonic() if _start_sec is None else _start_sec


def checked_for_sec() -> float:
    """Return for how many seconds *Validate* has checked these nodes; 0 in the grader.

    An endpoint that was not created in this time is not waited for again. The grader does not
    rely on this: a callback may still create the endpoint later.
    """
    return time.monotonic() - _start_sec if is_validating() and _start_sec is not None else 0.0


def begin_hidden_part() -> None:
    """Begin the cell's hidden part, which continues to the cell's end."""
    global _quiet
    _quiet = True
    _display(_MARK, _BEGAN)


def tell_failed_already() -> None:
    """Tell the grader that the failure raised at the end also occurred in the visible part."""
    if is_in_test_room():
        _display(_MARK, _ALREADY)


def is_quiet() -> bool:
    """Whether the reason of a failure is reduced to its cause, as in a hidden part."""
    return _quiet


def note_inputs() -> None:
    """Tell the grader that the check has chosen inputs."""
    if is_in_test_room():
        _display(_MARK, _INPUTS)


def student_text(text: object) -> str:
    """Mark a text that the student's code made; in quiet mode, reasons leave it out."""
    said = without_marks(str(text))  # a name received over DDS may contain any character
    return f'{_OPEN}{said}{_CLOSE}' if _quiet else said


def student_exception(said: str) -> str:
    """Mark an exception's text like "ValueError: …", except the name of a builtin exception."""
    kind, _, message = said.partition(':')
    if not isinstance(getattr(builtins, kind, None), type):
        return student_text(said)
    return f'{kind}: {student_text(message.strip())}' if message else kind


def without_marks(text: str) -> str:
    """Return a sentence without the marks of `student_text`, for those who may read all of it."""
    return text.replace(_OPEN, '').replace(_CLOSE, '')


def without_inputs(text: str) -> str:
    """Replace what the student's code made, and measured numbers, by '…'."""
    return _LIST.sub('…', _MEASURED.sub('…', _THEIRS.sub('…', text)))


def tell_grader(details: str) -> None:
    """Send the grader what only an instructor may read of a failure."""
    _display(_DETAILS, details)


def tell_points(earned: float) -> None:
    """Send the grader how many points a failed check still gives."""
    if is_in_test_room():
        _display(_POINTS, repr(float(earned)))


def points_in(outputs: Iterable[Any]) -> float:
    """Return the points that a cell's outputs report; 0 if they report none."""
    return float(next(iter(_data(outputs, _POINTS)), 0.0))


def tell_hint(hint: str) -> None:
    """Send the grader the words at the end of a reason that are its hint."""
    if is_in_test_room():
        _display(_HINT, hint)


def hint_in(outputs: Iterable[Any], reason: str) -> str:
    """Return the hint at a reason's end, if the cell's outputs report it; else ''."""
    return next((said for said in _data(outputs, _HINT) if reason.endswith(f': {said}')), '')


@contextmanager
def leave_quiet_mode() -> Iterator[None]:
    """Leave quiet mode meanwhile: for sentences that mention no hidden input."""
    global _quiet
    former, _quiet = _quiet, False
    try:
        yield
    finally:
        _quiet = former


def has_reached_hidden_part(outputs: Iterable[Any]) -> bool:
    """Whether a cell with these outputs reached its hidden part."""
    return _BEGAN in _data(outputs, _MARK)


def failed_only_in_hidden_part(outputs: Iterable[Any]) -> bool:
    """Whether a failed check failed in its hidden part, and not in the visible one."""
    said = _data(outputs, _MARK)
    return _BEGAN in said and _ALREADY not in said


def has_chosen_inputs(outputs: Iterable[Any]) -> bool:
    """Whether the hidden part chose inputs, so that the student's code knows them now."""
    said = _data(outputs, _MARK)
    return _BEGAN in said and _INPUTS in said


def details_in(outputs: Iterable[Any]) -> str:
    """Return the last sentence for the instructor in a cell's outputs, or ''."""
    return next(reversed(_data(outputs, _DETAILS)), '')[:MOST_DETAILS]


def visible_outputs(outputs: Sequence[Any]) -> list[Any]:
    """Return the outputs before the hidden part, without displays for the grader."""
    kept = []
    for output in outputs:
        if _BEGAN in _data([output], _MARK):
            break
        if not _is_for_the_grader(output):
            kept.append(output)
    return kept


def _data(outputs: Iterable[Any], mime: str) -> list[str]:
    return [out['data'][mime] for out in outputs if mime in (out.get('data') or ())]


def _is_for_the_grader(output: Any) -> bool:
    return bool({_MARK, _DETAILS, _POINTS, _HINT} & {*(output.get('data') or ())})


def _display(mime: str, text: str) -> None:
    from IPython.display import display

    display({mime: text}, raw=True)
