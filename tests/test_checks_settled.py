"""Whether a notebook may still make an endpoint: its process says so, while no cell runs."""

import json
import subprocess
import sys

import pytest

NODE = """
import rclpy
from rclpy.node import Node
rclpy.init()
node = Node('idle')
"""
HISTORY = """
import tempfile, threading
from IPython.core.interactiveshell import InteractiveShell
from traitlets.config import Config
file = f'{tempfile.mkdtemp()}/history.sqlite'
shell = InteractiveShell(config=Config(HistoryManager={'hist_file': file}))
assert 'IPythonHistorySavingThread' in [thread.name for thread in threading.enumerate()]
"""
LOOP = """
import asyncio, threading
loop = asyncio.new_event_loop()
threading.Thread(target=loop.run_forever, daemon=True).start()
"""
SCRIPT = """
from IPython.core.interactiveshell import InteractiveShell
InteractiveShell().run_cell_magic('bash', '', 'true')
import threading
assert any('run_forever' in thread.name for thread in threading.enumerate())
"""
NOTHING_COMES = {
    'nothing': ('', 0, []),
    'our own threads': ('import my_robot_basics.live.nodes.runner', 0, []),
    "IPython's thread for the history of cells": (HISTORY, 0, []),
    'the event loop of %%bash': (SCRIPT, 0, []),
    'a node without a timer': (NODE, 0, ['/idle']),
    'a node of the course': (NODE.replace('idle', '_idle'), 0, []),
    'a timer that is cancelled': (NODE + 'node.create_timer(1, print).cancel()', 0, ['/idle']),
    'a timer that has fired': (NODE + 'timer = node.create_timer(1, print)', 9, ['/idle']),
}
SOMETHING_MAY = {
    'a thread': (
        'import threading, time\n'
        'threading.Thread(target=time.sleep, args=[9], daemon=True).start()',
        9,
    ),
    'a thread that threading does not know': (
        'import _thread, time\ndef rest(): time.sleep(9)\n_thread.start_new_thread(rest, ())',
        9,
    ),
    'a task in an event loop of a thread': (
        LOOP + 'asyncio.run_coroutine_threadsafe(asyncio.sleep(9), loop)\n'
        'import time; time.sleep(0.2)',
        9,
    ),
    'a call in an event loop of a thread': (
        LOOP + 'loop.call_soon_threadsafe(loop.call_later, 9, print)\n'
        'import time; time.sleep(0.2)',
        9,
    ),
    'a process': ('import subprocess; child = subprocess.Popen(["sleep", "9"], stdout=-3)', 9),
    'a process whose parent is gone': ('import os; os.system("sleep 9 >/dev/null 2>&1 &")', 9),
    'an alarm': ('import signal; signal.setitimer(signal.ITIMER_REAL, 9)', 9),
    'a timer': (NODE + 'timer = node.create_timer(1, print)', 0),
    'a timer that has hardly fired': (NODE + 'timer = node.create_timer(1, print)', 2),
    'a slow timer': (NODE + 'timer = node.create_timer(8, print)', 9),
}
ASK = """
import json, os
from my_robot_basics.exchange.settled import settled_nodes
os.write(2, json.dumps(settled_nodes({lived_sec})).encode())
os._exit(0)
"""
IN_A_TASK = """
import asyncio
async def later(): await asyncio.sleep(9)
async def ask():
    task = asyncio.create_task(later())
    await asyncio.sleep(0)
{ask}
asyncio.run(ask())
"""


def told(source):
    """What a process reports after it has run this code; like a kernel, it has its own session."""
    run = subprocess.run(
        [sys.executable, '-P', '-c', source],
        capture_output=True,
        text=True,
        check=True,
        start_new_session=True,
    )
    return json.loads(run.stderr)


@pytest.mark.parametrize(
    ('source', 'lived_sec', 'names'), NOTHING_COMES.values(), ids=NOTHING_COMES
)
def test_nodes_are_listed_if_no_endpoint_can_appear(source, lived_sec, names):
    assert told(source + ASK.format(lived_sec=lived_sec)) == names


@pytest.mark.parametrize(('source', 'lived_sec'), SOMETHING_MAY.values(), ids=SOMETHING_MAY)
def test_no_list_is_given_if_an_endpoint_may_appear(source, lived_sec):
    assert told(source + ASK.format(lived_sec=lived_sec)) is None


def test_no_list_is_given_while_an_asyncio_task_runs():
    ask = ASK.format(lived_sec=9).replace('\n', '\n    ')
    assert told(IN_A_TASK.format(ask=ask)) is None
