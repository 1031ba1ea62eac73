"""How often a plain node does not end after SIGTERM, and after SIGINT.

    .venv/bin/python tests/benchmarks/ended_by_signal.py [TIMES]

Beside a busy loop for each processor, three nodes run at a time: one for each signal, and one that
gets SIGINT although it was started with SIGINT ignored, as children of a shell's `&` are; rclpy
installs its own handler. Nothing is asserted.
"""

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

from measuring import table

NODE = """
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

try:
    rclpy.init()
    node = Node('plain')
    print('ready', flush=True)
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    rclpy.try_shutdown()
"""
GIVEN_UP_SEC = 10.0
LATEST_SEC = 0.6
IGNORED = 'SIGINT, once ignored'
WAYS = {'SIGTERM': signal.SIGTERM, 'SIGINT': signal.SIGINT, IGNORED: signal.SIGINT}


def ends(way: str) -> bool:
    """Whether a node ends after a signal, sent some tenths of a second after it is ready."""

    def prepare() -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN if way == IGNORED else signal.SIG_DFL)

    command = [sys.executable, '-c', NODE]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, preexec_fn=prepare
    ) as node:
        assert node.stdout is not None
        assert node.stdout.readline() == b'ready\n'
        time.sleep(random.uniform(0.1, LATEST_SEC))
        node.send_signal(WAYS[way])
        try:
            node.wait(GIVEN_UP_SEC)
        except subprocess.TimeoutExpired:
            node.kill()
            return False
    return True


def main() -> None:
    """Count the nodes that do not end."""
    times = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    loops = [
        subprocess.Popen([sys.executable, '-c', 'while True: pass'])
        for _ in range(len(os.sched_getaffinity(0)))
    ]
    wait_on: Counter[str] = Counter()
    try:
        with ThreadPoolExecutor(len(WAYS)) as nodes:
            for _ in range(times):
                ended = zip(WAYS, nodes.map(ends, WAYS), strict=True)
                wait_on.update(way for way, has_ended in ended if not has_ended)
    finally:
        for loop in loops:
            loop.kill()
    table(('', 'nodes', 'wait on'), [(way, times, wait_on[way]) for way in WAYS])


if __name__ == '__main__':
    main()
