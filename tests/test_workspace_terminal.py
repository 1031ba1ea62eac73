"""JupyterLab's terminal, as `./course lab` serves it: the commands of the lessons work in it."""

import asyncio
import json
import os
import re
import socket
import subprocess
import time
from pathlib import Path

import nbformat
import pytest
from my_robot_basics.live.packages.workspace import BUILD, make_workspace
from ros2_command import TIMEOUT_SEC
from tornado.httpclient import AsyncHTTPClient
from tornado.websocket import websocket_connect

ROOT = Path(__file__).parents[1]
TOKEN = 'let-me-in'
BASHRC = """
export PATH=/usr/bin:/bin  # where a robot's ROS was first, .venv is not
export ROS_DOMAIN_ID=42 PYTHONPATH=/opt/ros/humble/python AMENT_PREFIX_PATH=/opt/ros/humble
"""


@pytest.fixture
def lab(tmp_path, monkeypatch):
    """The address of a JupyterLab, for somebody whose ~/.bashrc sets another ROS up."""
    (tmp_path / '.bashrc').write_text(BASHRC)
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path / 'ros ws'))
    make_workspace()
    environment = {**os.environ, 'HOME': str(tmp_path), 'SHELL': '/bin/sh'}
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        port = free.getsockname()[1]
    log = tmp_path / 'log'
    options = [f'--port={port}', '--ServerApp.port_retries=0', f'--IdentityProvider.token={TOKEN}']
    with log.open('w') as file:
        server = subprocess.Popen(
            [ROOT / 'course', 'lab', '--no-browser', *options],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=file,
        )
    try:
        deadline = time.monotonic() + 2 * TIMEOUT_SEC
        while 'is running at' not in log.read_text() or not answers(port):
            assert server.poll() is None, log.read_text()
            assert time.monotonic() < deadline, log.read_text()
            time.sleep(0.1)
        yield f'127.0.0.1:{port}'
    finally:
        server.terminate()
        server.wait()


def answers(port):
    with socket.socket() as probe:
        return probe.connect_ex(('127.0.0.1', port)) == 0


async def _type(address, dialogue):
    """Open a terminal; type each line when the one before has shown what it must."""
    authorised = f'http://{address}/api/terminals?token={TOKEN}'
    await AsyncHTTPClient().fetch(authorised, method='POST', body='{}')
    terminal = await websocket_connect(f'ws://{address}/terminals/websocket/1?token={TOKEN}')
    try:
        for line, answer in dialogue:
            await terminal.write_message(json.dumps(['stdin', f'{line}\r']))
            seen = ''
            try:
                async with asyncio.timeout(TIMEOUT_SEC):  # nodes go on speaking meanwhile
                    while not re.search(answer, seen):
                        kind, *text = json.loads(await terminal.read_message())
                        seen += text[0] if kind == 'stdout' else ''
            except TimeoutError:
                pytest.fail(f'no {answer!r} after {line!r}, but {seen!r}')
    finally:
        terminal.close()


TOPIC = '/kinematics/joint_states'
POSE = '"{name: [joint1, joint2], position: [0.5, -1.2]}"'
NODES = 'ros2 run my_robot_basics'
COMMANDS = (
    (f'{NODES} kinematics_subscriber &', 'waiting for poses on'),
    (f'{NODES} kinematics_publisher &', 'IK finds it as'),
    (f'{NODES} kinematics_publisher --ros-args -r {TOPIC}:=/shown &', 'publishing a random pose'),
    ('ros2 node list', r'\n/kinematics_subscriber\b'),
    ('ros2 topic list', r'\n/shown\b'),
    (f'ros2 topic info {TOPIC}', 'Publisher count: 1'),
    (f'ros2 topic info --verbose {TOPIC}', 'Node name: kinematics_subscriber'),
    (f'ros2 topic echo --once {TOPIC} --field name', r"\['joint1', 'joint2'\]"),
    (f'timeout -s INT 60 ros2 topic hz {TOPIC} | head -n 1', r'average rate: [01]\.\d'),
    ('ros2 interface show sensor_msgs/msg/JointState', r'float64\[\] effort'),
    (f'ros2 topic pub --once {TOPIC} sensor_msgs/msg/JointState {POSE}', 'publishing #1'),
    (f'topic_doctor --seconds 3 {TOPIC}', f'All is well on {TOPIC}'),
)
"""Each line to type, and the output to wait for before the next, which the line does not hold."""


@pytest.mark.slow
def test_the_commands_of_the_lessons_work_in_jupyterlabs_terminal(lab):
    install = r'ros ws/install/my_robot_basics/lib/my_robot_basics/kinematics_publisher'
    dialogue = [
        ('echo "<$ROS_DOMAIN_ID$PYTHONPATH>"', '<>'),
        (BUILD, r'Finished <<< my_robot_basics'),
        ('ros2 pkg executables my_robot_basics --full-path | cat', install),
        # a domain that is named: other tests' lessons start and end meanwhile
        (f'export ROS_DOMAIN_ID={os.environ["ROS_DOMAIN_ID"]}', ''),
        *COMMANDS,
        ('kill %1 %2 %3; wait; echo do""ne', 'done'),
    ]
    asyncio.run(_type(lab, dialogue))


PROGRAMS = r'(?:ros2|topic_doctor|colcon|source|timeout)\b'


def test_every_command_named_in_a_text_is_run_in_a_terminal_test_or_a_lesson():
    notebooks = [nbformat.read(path, as_version=4) for path in ROOT.glob('solutions/*/*.ipynb')]
    cells = [cell for notebook in notebooks for cell in notebook.cells]
    run = [line for c in cells if c.cell_type == 'code' for line in c.source.splitlines()]
    run += [BUILD, *(line for line, _ in COMMANDS)]
    page = ROOT / 'solutions' / '07_common_errors' / 'checklist.html'
    texts = [page.read_text(), (ROOT / 'solutions' / 'terms.md').read_text()]
    texts += [cell.source for cell in cells if cell.cell_type == 'markdown']
    named = {
        command
        for text in texts
        for command in re.findall(rf'(?:`|<code>|terminal \d: +)({PROGRAMS}[^`<\n]*)', text)
    }
    assert len(named) > 10
    known = [set(line.replace('!', '').split()) for line in run]
    assert [c for c in named if not any(set(c.split()) <= words for words in known)] == []
