"""Log lines contain no escape sequence, whatever names and messages contain."""

import re
import subprocess
import sys

import pytest

OURS = """
import logging
from grader.common.logs import log_visibly
log_visibly()
log = logging
"""
NBGRADERS = """
from nbgrader.apps.baseapp import NbGrader
from traitlets.config import Config
from grader.common.logs import NBGRADER_LOGGING
log = NbGrader(config=Config({'NbGrader': {'logging_config': NBGRADER_LOGGING}})).log
"""
NAME = 'a\x1b[31m\x07red\u202e'
LOGGED = f"""
log.error('%s of %s', 'toy', {NAME!r})
try:
    raise ValueError({NAME!r})
except ValueError:
    log.exception('lines\\nstay')
"""


@pytest.mark.parametrize('logging', [OURS, NBGRADERS], ids=['./course', 'nbgrader'])
def test_no_escape_sequence_in_a_name_reaches_the_terminal(logging):
    run = subprocess.run(
        [sys.executable, '-P', '-c', logging + LOGGED], capture_output=True, text=True, check=True
    )
    assert r'toy of a\x1b[31m\x07red\u202e' in run.stderr
    assert r'ValueError: a\x1b[31m\x07red\u202e' in run.stderr
    assert re.search(r'lines\n *stay', run.stderr)
    assert not {'\x1b', '\x07', '\u202e'}.intersection(run.stderr)
