"""Describe an error in a student's own cell in a sentence."""

import re

from my_robot_basics.feedback.python_errors import with_hint
from my_robot_basics.session.errors import without_signatures
from my_robot_basics.validate.kernels.limits import FLOOD_CHARACTERS
from my_robot_basics.validate.kernels.outputs import CUT_OFF, CellRun
from my_robot_basics.validate.text import printable, shorten

TROUBLE = 'your cell '
"""Notes about errors in the student's cells begin with this."""
MOST_OF_A_LINE = 120
"""How many characters of a line that Python cannot parse are quoted."""
_TEMPORARY_FILE = re.compile(
    r'\((?:<(?:ipython-input|tokenize|string)[^>]*>|\d+\.py), (line \d+)\)'
)
"""The file name of a cell in a SyntaxError, which means nothing to a student."""
_COLOURS = re.compile(r'\x1b\[[\d;]*m')
_OWN_LINE = re.compile(
    r'^Cell In\[\d+\], line (\d+).*?^-*> ?\1 +(\S[^\n]*)$', re.MULTILINE | re.DOTALL
)
"""A frame of the notebook's own code in IPython's traceback: line number and code."""
_POINTED_AT = re.compile(r'^ *(\S[^\n]*)\n *\^', re.MULTILINE)
"""A line of code in a traceback with a caret below it."""


def describe_cell_error(name: str, run: CellRun) -> str | None:
    """Describe the error in one of the student's cells, with a hint if there is one; or None."""
    if run.cut_off:
        return f'{TROUBLE}`{name}` {CUT_OFF}'
    if run.timed_out:
        what = f'printed over {FLOOD_CHARACTERS:,} characters' if run.flooded else 'did not end'
        how = 'could not be' if run.died else 'was'
        return f'{TROUBLE}`{name}` {what} and {how} interrupted'
    if run.died:
        return f'{TROUBLE}`{name}` ended the kernel' + (f': {run.ending}' if run.ending else '')
    if run.error is not None and run.error.ename == 'StdinNotImplementedError':
        return (
            f'{TROUBLE}`{name}` calls input(), and nobody answers: write the value into the code'
        )
    if run.error is not None:
        what = without_signatures(run.error.evalue) or _own_line(run.error.traceback)
        line = _unparsed_line(run.error.traceback)
        said = _TEMPORARY_FILE.sub(
            lambda found: f'({found[1]}{line})', f'{run.error.ename}: {what}', count=1
        ).rstrip(': ')
        return with_hint(f'{TROUBLE}`{name}` stopped with {shorten(printable(said), 300)}')
    return None


def _own_line(traceback: list[str]) -> str:
    """Return the student's last line in a traceback; '' if it is a `raise` statement."""
    lines = _OWN_LINE.findall(_COLOURS.sub('', '\n'.join(traceback)))
    number, code = lines[-1] if lines else ('', 'raise')
    return '' if code.startswith('raise') else f'line {number}: {code}'


def _unparsed_line(traceback: list[str]) -> str:
    """Return ': ' and the line that Python could not parse; '' if the traceback shows none."""
    lines = _POINTED_AT.findall(_COLOURS.sub('', '\n'.join(traceback)))
    return f': {lines[-1][:MOST_OF_A_LINE]}' if lines else ''
