"""Times to the first line of `ros2 topic list`, `info` and `echo --once`, cold, on one publisher.

    .venv/bin/python tests/benchmarks/ros2_first_output.py [RUNS]

Each run is a new process, without a daemon. For comparison, it also times what is not ours: the
start of Python, and importing rclpy and making one node. Nothing is asserted.
"""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from my_robot_basics.session import classroom
from ros2_command import SCRIPT, on_the_graph

TOPIC = '/kinematics/joint_states'
ONE_NODE = 'import rclpy; rclpy.init(); rclpy.create_node("_bare"); print()'
COMMANDS = {
    'python, nothing else': [sys.executable, '-c', 'print()'],
    'rclpy, one node': [sys.executable, '-c', ONE_NODE],
    'ros2 topic list': [SCRIPT, 'topic', 'list'],
    'ros2 topic info': [SCRIPT, 'topic', 'info', TOPIC],
    'ros2 topic echo --once': [SCRIPT, 'topic', 'echo', '--once', TOPIC],
}


def main(runs: int = 5) -> None:
    """Print a line for each command."""
    classroom.enter()  # the node and the commands inherit the domain
    with on_the_graph('fifty_hz', topics=(TOPIC,)):
        print(f'{"seconds to the first line":26} median   best  worst   of {runs}')
        for name, command in COMMANDS.items():
            took = [first_line_sec(command) for _ in range(runs)]
            numbers = statistics.median(took), min(took), max(took)
            print(f'{name:26}', *(f'{number:6.2f}' for number in numbers))


def first_line_sec(command: list[str | Path]) -> float:
    """Return the seconds from the start of a process to its first line."""
    # as in a new terminal: the ROS wheels then restart Python once, to set a library path
    ours = ('_ROS_WHEELS_BOOTSTRAP_COMPLETE', 'LD_LIBRARY_PATH', 'PYTHONDONTWRITEBYTECODE')
    environment = {name: value for name, value in os.environ.items() if name not in ours}
    began = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment)
    process.stdout.readline()
    took = time.perf_counter() - began
    process.communicate()
    return took


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
