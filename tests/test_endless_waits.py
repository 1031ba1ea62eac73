"""rclpy's EventsExecutor waits without a limit, in each Python of .venv, and ends when told to."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.starts

PROGRAM = """
import threading
import rclpy
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.executors import ExternalShutdownException

rclpy.init()
node, executor = rclpy.create_node('_events'), EventsExecutor()
done = rclpy.task.Future()
node.create_timer(0.1, lambda: (print('called', flush=True), done.set_result(None)))
executor.add_node(node)
"""
WAITS = {
    'spin_once': 'executor.spin_once()',
    'spin_until': 'executor.spin_until_future_complete(done)',
    'spin_once_until': 'executor.spin_once_until_future_complete(done)',
    'with_a_limit': 'executor.spin_until_future_complete(done, 30.0); executor.spin_once(30.0)',
    'spin': 'threading.Timer(1.0, executor.shutdown).start(); executor.spin()',
    'spin_in_a_thread': (
        'threading.Thread(target=executor.spin, daemon=True).start(); '
        'rclpy.spin_until_future_complete(rclpy.create_node("_other"), done)'
    ),
}


@pytest.mark.parametrize('wait', WAITS)
def test_each_way_to_wait_calls_a_timer_and_ends(wait):
    program = f'{PROGRAM}{WAITS[wait]}\nprint("ended", flush=True)\nrclpy.try_shutdown()\n'
    command = [sys.executable, '-P', '-c', program]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert {'called', 'ended'} == set(ended.stdout.split()), ended.stderr
