"""What live does to a process that imports it."""

import subprocess
import sys
from types import SimpleNamespace

import pytest
from my_robot_basics.session.errors import tell

FORGET = """
import weakref

import rclpy
from my_robot_basics.live.nodes import runner
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerGuardCondition


class Careless:
    def __del__(self):
        raise ValueError('of the student')


runner.set_up()
rclpy.init(args=[])
executor = SingleThreadedExecutor()
rclpy.get_default_context()._callbacks.clear()  # as when two threads remove at once
known = [weakref.WeakMethod(executor.wake, rclpy.get_default_context()._remove_callback)]
executor.shutdown()
del executor
careless = Careless()
del careless
# as when an interrupt comes while one is made
SingleThreadedExecutor.__new__(SingleThreadedExecutor)
SignalHandlerGuardCondition.__new__(SignalHandlerGuardCondition)
rclpy.shutdown()
"""

INTERRUPTED = """
import os
import signal
import time

import rclpy
from my_robot_basics.live import run
from rclpy.node import Node


class Arm(Node):
    def __init__(self):
        super().__init__('arm')


def main():
    rclpy.init(args=[])
    node = Arm()
    try:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(10.0)
    except KeyboardInterrupt:
        time.sleep({pause_sec})
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


run(Arm)
rclpy.shutdown()
main()
print('starts', run(Arm) is not None)
time.sleep(0.5)
print('lives', rclpy.ok())
"""


@pytest.mark.parametrize('pause_sec', [0.0, 0.5], ids=['at_once', 'later'])
def test_a_node_starts_and_stays_alive_after_an_interrupted_main(pause_sec):
    # rclpy's own signal handler ends all contexts of the process, in a thread, sooner or later
    script = INTERRUPTED.format(pause_sec=pause_sec)
    run = subprocess.run(
        [sys.executable, '-c', script], capture_output=True, text=True, check=False
    )
    assert run.stdout.splitlines()[-2:] == ['starts True', 'lives True'], run.stderr


def test_errors_from_races_in_rclpy_are_hidden_and_other_errors_are_shown():
    run = subprocess.run(
        [sys.executable, '-c', FORGET], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0
    assert 'list.remove' not in run.stderr
    assert 'AttributeError' not in run.stderr
    assert 'ValueError: of the student' in run.stderr


def test_tell_writes_a_text_of_several_lines_at_once(monkeypatch):
    pieces = []
    stdout = SimpleNamespace(write=pieces.append, flush=lambda: None)
    monkeypatch.setattr(sys, 'stdout', stdout)
    tell('One sentence, and another one. ' * 6, in_one=False)
    monkeypatch.undo()
    [piece] = filter(None, pieces)
    assert piece.count('\n') == 3
    assert piece.endswith('one.\n')
