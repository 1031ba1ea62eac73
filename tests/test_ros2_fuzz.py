"""Any command line ends with an exit status, and never with a traceback."""

import argparse
import importlib
import io
import sys
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from my_robot_basics.ros2 import main, stopping
from my_robot_basics.ros2.errors import Stopped
from my_robot_basics.ros2.graph import Graph
from my_robot_basics.ros2.table import COMMANDS

VERBS = [(c, verb) for c, command in COMMANDS.items() for verb in command.verbs or ('',)]
NAMES = [
    '/',
    '/x',
    'x y',
    '~',
    '{node}',
    '/_x',
    '//',
    '/kinematics/joint_states',
    '',
    '-',
    '\udcff',
]
TYPES = [
    'std_srvs/SetBool',
    'std_msgs/msg/String',
    'std_msgs/String',
    'a/b/c',
    '/',
    'os/path',
    '..',
    'std_msgs/msg/',
]
WORDS = (
    st.sampled_from([*NAMES, *TYPES, '{}', '{data: 1}', '{data: [', '-1', '--', '[', '*', 'nan'])
    | st.text(max_size=8)
    | st.integers().map(str)
    | st.floats().map(str)
)


def option_words(words):
    """Option strings of a verb, with arguments of any kind."""
    parser = argparse.ArgumentParser()
    name = '_'.join(word for word in words if word)
    importlib.import_module(f'my_robot_basics.ros2.verbs.{name}').add_arguments(parser)
    # evaluating any text as Python is what --filter is for
    options = [o for a in parser._actions for o in a.option_strings if 'filter' not in o]
    return st.sampled_from(options)


@st.composite
def command_lines(draw):
    words = draw(st.sampled_from(VERBS))
    rest = draw(st.lists(WORDS | option_words(words), max_size=6))
    return [word for word in words if word] + [word for word in rest if word != '--filter']


class BriefGraph(Graph):
    """Stops as if by a signal, after a moment."""

    def check(self):
        self.until = getattr(self, 'until', time.monotonic() + 0.02)
        if time.monotonic() > self.until:
            raise Stopped(2)


@pytest.fixture
def in_this_process(monkeypatch):
    monkeypatch.setattr(stopping, 'set_handlers', lambda: None)
    monkeypatch.setattr(stopping, 'only_record_signals', lambda: None)
    for command, verb in VERBS:
        name = f'{command}_{verb}'.rstrip('_')
        module = importlib.import_module(f'my_robot_basics.ros2.verbs.{name}')
        if hasattr(module, 'Graph'):
            monkeypatch.setattr(module, 'Graph', BriefGraph)


@pytest.mark.slow
@pytest.mark.starts
@settings(
    max_examples=300,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(words=command_lines())
def test_no_command_line_ends_in_a_traceback(words, in_this_process, capfd):
    before, sys.stdin = sys.stdin, io.TextIOWrapper(io.BytesIO(b'data: x'))
    try:
        status = main.main(words)
    except SystemExit as ended:
        status = ended.code
    finally:
        sys.stdin = before
    assert status is None or isinstance(status, int | str)
    assert 'Traceback' not in capfd.readouterr().err
