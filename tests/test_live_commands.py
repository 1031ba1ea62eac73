"""Command lines of a notebook run as processes, and end with the notebook."""

import os
import signal
import subprocess
import sys
import time

import pytest
from my_robot_basics.live.packages import commands
from my_robot_basics.ros2 import command_line
from my_robot_basics.session.errors import NotRunnable

from my_robot_basics import live

pytestmark = pytest.mark.starts
START = 'ros2 run my_robot_basics kinematics_publisher --ros-args'


@pytest.fixture(autouse=True)
def end():
    yield
    commands.stop_commands()


@pytest.fixture
def notebook(monkeypatch):
    return lambda **names: [
        monkeypatch.setattr(sys.modules['__main__'], name, value, raising=False)
        for name, value in names.items()
    ]


def test_commands_run_until_live_stop(notebook, capsys):
    notebook(left=f'{START} -r __ns:=/left', right=f'{START} -r __ns:=/right')
    live.run_commands('left', 'right')
    assert capsys.readouterr().out == 'left: started\nright: started\n'
    processes = [command.process for command in commands._running]
    assert [process.poll() for process in processes] == [None, None]
    live.stop()
    assert None not in [process.poll() for process in processes]
    assert commands._running == []


def test_running_a_command_again_replaces_its_process(notebook):
    notebook(left=START)
    live.run_commands('left')
    [before] = commands._running
    live.run_commands('left')
    [after] = commands._running
    assert before.process.poll() is not None
    assert after.process.poll() is None


@pytest.mark.parametrize(
    ('rest', 'why'),
    [
        ('-p seed=7', "a parameter is written name:=value, so put := into 'seed=7'"),
        ('--param seed:7', "a parameter is written name:=value, so put := into 'seed:7'"),
        ('-p seed:=7 -r __ns=/a', "a rule is written name:=new_name, so put := into '__ns=/a'"),
    ],
)
def test_a_word_without_its_sign_is_named_and_not_quoted_from_rcl(
    notebook, capsys, monkeypatch, rest, why
):
    monkeypatch.setattr(commands, 'STARTED_SEC', 60.0)  # a slow start is not under test
    notebook(left=f'{START} {rest}')
    live.run_commands('left')
    assert ' '.join(capsys.readouterr().out.split()) == f'left: ended by itself: {why}'


def test_the_last_output_of_a_command_that_ends_is_printed(notebook, capsys, monkeypatch):
    monkeypatch.setattr(commands, 'STARTED_SEC', 60.0)  # a slow start is not under test
    notebook(left=f'{START} -r __ns:=left')
    live.run_commands('left')
    printed = ' '.join(capsys.readouterr().out.split())
    assert printed.startswith('left: ended by itself: ')
    assert "Couldn't parse remap rule: '-r __ns:=left'" in printed


@pytest.mark.parametrize(
    ('value', 'words'),
    [
        (None, 'expected a command line left, saw nothing of that name: write it in the answer'),
        (5, 'expected left to be a text, saw int: put it in quotes, and no'),
        (f'{START}; touch here', 'left: expected one command line, saw the word ;: write one'),
    ],
)
def test_a_value_that_is_not_one_command_line_is_not_run(
    notebook, tmp_path, monkeypatch, value, words
):
    monkeypatch.chdir(tmp_path)
    notebook(left=value, right=START)
    with pytest.raises(NotRunnable, match=words):
        live.run_commands('right', 'left')
    assert commands._running == []
    assert list(tmp_path.iterdir()) == []


def test_a_subclass_of_str_is_not_run_as_a_command_line(notebook):
    class Text(str):
        def strip(self):
            return START

    notebook(left=Text('id'))
    with pytest.raises(NotRunnable, match='saw Text'):
        live.run_commands('left')


def test_a_notebook_that_is_killed_leaves_no_node_behind():
    program = f'left = {START!r}\n' + (
        'import os, signal\n'
        'from my_robot_basics.live import run_commands\n'
        'from my_robot_basics.live.packages import commands\n'
        "run_commands('left')\n"
        'print(commands._running[0].process.pid, flush=True)\n'
        'os.kill(os.getpid(), signal.SIGKILL)\n'
    )
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True)
    assert done.returncode == -signal.SIGKILL
    pid = int(done.stdout.split()[-1])
    deadline = time.monotonic() + 30.0
    while is_alive(pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not is_alive(pid)


def is_alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    with open(f'/proc/{pid}/stat') as stat:
        return stat.read().rpartition(')')[2].split()[0] != 'Z'


def test_a_parsed_command_line_begins_with_ros2():
    line = command_line.parse(START, package='my_robot_basics', executable='kinematics_publisher')
    assert line.words == tuple(START.split())
