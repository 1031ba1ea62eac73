"""Code and replies for two kernels: the probe message, and a check's requests to the student.

DDS is the only direct path between the rooms: the process that has started both kernels passes
on requests as text, and returns replies of a bounded size.
"""

import ast
import contextlib
import json
import re

from my_robot_basics.validate.kernels.limits import FLOOD_CHARACTERS, MAX_REPLY_CHARACTERS
from my_robot_basics.validate.kernels.outputs import CUT_OFF, CellRun

STUDENT_COMES = """
from my_robot_basics.exchange import probe
probe.announce()
"""
TEST_RECEIVES = """
from my_robot_basics.exchange import probe
probe.receive()
"""
STUDENT_GOES = (
    'import sys; probe.remove_announcement(); sys.path.append({files!r}); del probe, sys'
)
"""The student's modules come last in sys.path, and after the probe: else they could replace
optional modules that libraries try to import. No name of this code stays in the notebook."""

_RESPONDER = (
    "__import__('my_robot_basics.exchange.responder', fromlist=['answer']).answer({request!r})"
)
_ESCAPE = r"""\\(?:[\\'"nrt]|x[0-9a-f]{2}|u[0-9a-f]{4}|U[0-9a-f]{8})"""
_STRING = re.compile(rf"""'(?:[^'\\\n]|{_ESCAPE})*'|"(?:[^"\\\n]|{_ESCAPE})*\"""")
"""Matches one Python string literal as `repr` writes it, and no other Python code."""


def as_expression(request: str) -> dict[str, str]:
    """Return the user expression that answers a check's request in the student's kernel."""
    return {'reply': _RESPONDER.format(request=request)}


def reply_of(run: CellRun, *, within_sec: float, at_grading_sec: float = 0.0) -> str:
    """Return the text for the check: the reply in `run`, or why there is none.

    `within_sec` is how long the kernel had; `at_grading_sec`, the limit there, if it is longer.
    """
    if run.cut_off:
        why = CUT_OFF  # in lower case: translation takes a place in capitals for a name
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
        case {'reply': {'data': {'text/plain': str(text)}}} if len(text) > MAX_REPLY_CHARACTERS:
            return _failed(f'an answer of {len(text):,} characters')
        case {'reply': {'data': {'text/plain': str(text)}}} if _STRING.fullmatch(text):
            # an invalid code point or a lone surrogate is refused
            with contextlib.suppress(SyntaxError, ValueError):
                return ast.literal_eval(text).encode().decode()
    return _failed('no usable answer')


def _failed(sentence: str) -> str:
    return json.dumps({'failed': sentence})
