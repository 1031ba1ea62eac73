"""What two kernels need to meet: a message that crosses, and a check's questions to the student.

The rooms have no path to each other but DDS: what holds both kernels takes questions over as text,
and text of a bounded size back.
"""

import ast
import contextlib
import json
import re

from my_robot_basics.validate.limits import FLOOD_CHARACTERS, MAX_REPLY
from my_robot_basics.validate.outputs import CUT_OFF, CellRun

STUDENT_COMES = """
from my_robot_basics.exchange import probe
probe.announce()
"""
TEST_RECEIVES = """
from my_robot_basics.exchange import probe
probe.receive()
"""
STUDENT_GOES = 'import sys; probe.silence(); sys.path.append({files!r}); del probe, sys'
"""Modules of the student's come last, and after the probe: libraries look for some that they may
do without. Nothing of ours stays among the names of the notebook."""

_RESPONDER = (
    "__import__('my_robot_basics.exchange.responder', fromlist=['answer']).answer({request!r})"
)
_ESCAPE = r"""\\(?:[\\'"nrt]|x[0-9a-f]{2}|u[0-9a-f]{4}|U[0-9a-f]{8})"""
_STRING = re.compile(rf"""'(?:[^'\\\n]|{_ESCAPE})*'|"(?:[^"\\\n]|{_ESCAPE})*\"""")
"""The literal of one string as Python writes it, and no other Python."""


def as_expression(request: str) -> dict[str, str]:
    """Return the user expression that answers a check's question in the student's kernel."""
    return {'reply': _RESPONDER.format(request=request)}


def reply_of(run: CellRun, *, within_sec: float, at_grading_sec: float = 0.0) -> str:
    """Return what came of it in so long as text for the check: a reply, or why there is none.

    `at_grading_sec` is how long it has there, if that is longer.
    """
    if run.cut_off:
        why = CUT_OFF  # a sentence of its own: what stands in a place in capitals is a name
        return _failed(f'no answer: your code {why}')
    if run.flooded:
        return _failed(f'no answer in {FLOOD_CHARACTERS:,} characters of output')
    if run.timed_out:
        if at_grading_sec:
            return _failed(
                f'no answer within {within_sec:g} s; at grading it has {at_grading_sec:g} s'
            )
        return _failed(f'no answer within {within_sec:g} s')
    if run.died:
        return _failed('the kernel of your notebook has ended')
    match run.expressions:
        case {'reply': {'data': {'text/plain': str(text)}}} if len(text) > MAX_REPLY:
            return _failed(f'an answer of {len(text):,} characters')
        case {'reply': {'data': {'text/plain': str(text)}}} if _STRING.fullmatch(text):
            # a number that is no character, or half a surrogate pair, is no text for the test
            with contextlib.suppress(SyntaxError, ValueError):
                return ast.literal_eval(text).encode().decode()
    return _failed('no usable answer')


def _failed(sentence: str) -> str:
    return json.dumps({'failed': sentence})
