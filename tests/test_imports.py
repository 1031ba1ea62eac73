"""Importing a name of the package changes nothing in the process that imports it."""

import json
import os
import subprocess
import sys

import pytest

from my_robot_basics import checks, live

LIBRARIES = 'logging, concurrent.futures.thread, rclpy, std_msgs.msg, matplotlib, IPython.display'
"""Libraries that may register functions for the end of Python when they are imported."""
PROGRAM = """
import atexit, json, os, sys, threading
import {libraries}
from IPython.core.interactiveshell import InteractiveShell

shell = InteractiveShell.instance()
shell.kernel = object()  # as in a notebook

def state():
    files = sorted(os.readlink(f'/proc/self/fd/{{fd}}') for fd in os.listdir('/proc/self/fd')
                   if os.path.exists(f'/proc/self/fd/{{fd}}'))
    return dict(
        environment=dict(os.environ), files=[f for f in files if '/fd' not in f],
        sockets=sum('socket:' in f for f in files), at_exit=atexit._ncallbacks(),
        hooks=[id(threading.excepthook), id(sys.unraisablehook), id(sys.excepthook)],
        events={{name: len(functions) for name, functions in shell.events.callbacks.items()}},
        magics=sorted(shell.magics_manager.magics['cell']),
        threads=threading.active_count(), rclpy=[id(rclpy.init), id(rclpy.spin)],
    )

before = state()
{imports}
print(json.dumps([before, state()]))
"""
IMPORTS = {
    'live': f'from my_robot_basics.live import {", ".join(live.__all__)}',
    'live.nodes.runner': 'import my_robot_basics.live.nodes.runner',
    'live.extension': 'import my_robot_basics.live.extension',
    'checks': f'from my_robot_basics.checks import {", ".join(checks.__all__)}',
    'checks.tick': 'import my_robot_basics.checks.clock.tick',
    'doctor': 'import my_robot_basics.doctor.main, my_robot_basics.doctor.looking',
    'ros2': 'import my_robot_basics.ros2.main, my_robot_basics.ros2.graph',
    'exchange': 'import my_robot_basics.exchange.probe, my_robot_basics.exchange.responder',
}
SETTING_UP = 'from my_robot_basics.live.nodes import runner; del shell.kernel; runner.set_up()'


def states(imports):
    program = PROGRAM.format(libraries=LIBRARIES, imports=imports)
    environment = {k: v for k, v in os.environ.items() if not k.startswith('MY_ROBOT_BASICS')}
    ended = subprocess.run(
        [sys.executable, '-P', '-c', program], capture_output=True, text=True, env=environment
    )
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


@pytest.mark.parametrize('imports', IMPORTS.values(), ids=IMPORTS)
def test_an_import_changes_nothing_in_the_process(imports):
    before, after = states(imports)
    assert after == before


def test_setting_up_changes_the_environment_sockets_and_hooks():
    before, after = states(SETTING_UP)
    assert {key for key in before if before[key] != after[key]} >= {
        'environment',
        'sockets',
        'at_exit',
        'hooks',
    }
    assert after['environment']['ROS_DOMAIN_ID']
