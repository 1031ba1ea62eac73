"""Sixty seconds of robot time at 5 Hz: messages counted, and the wall and CPU time that it takes.

    .venv/bin/python tests/benchmarks/sixty_seconds.py [RUNS]

The node runs in a process of its own, whose CPU time does not
count; 300 of 300 messages are right. Nothing is asserted.
"""

import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'nodes'))

from my_robot_basics.checks import topic
from my_robot_basics.session import classroom
from running import running

TOPIC = '/kinematics/joint_states'


def main(runs: int = 5) -> None:
    """Print a line for each run, then the median."""
    took, used = [], []
    classroom.enter()  # the node inherits the domain
    with running('five_hz'):
        for _ in range(runs):
            began, cpu = time.perf_counter(), time.process_time()
            recording = topic(TOPIC).record(seconds=60.0)
            took.append(time.perf_counter() - began)
            used.append(time.process_time() - cpu)
            count = len(recording.messages)
            print(f'{count} of 300 messages on the {recording.clock} clock in {took[-1]:.2f} s')
            alive = topic(TOPIC).wait_for(timeout_sec=2.0)
            print(f'  then alive on wall time: a stamp of {time.time() - _sec(alive):.2f} s ago')
    print(f'Median {statistics.median(took):.2f} s, {statistics.median(used):.3f} s of CPU')


def _sec(message: object) -> float:
    stamp = message.header.stamp
    return stamp.sec + stamp.nanosec * 1e-9


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
