"""Sixty seconds of robot time at 5 Hz: messages counted, and the wall and CPU time that it takes.

    .venv/bin/python tests/benchmarks/sixty_seconds.py [RUNS]

Discovering a node takes DDS some time, once in each cell: it is printed separately. The node runs
in a separate process, whose CPU time is not counted; 300 of 300 messages are right. Nothing is
asserted.
"""

import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'nodes'))

from my_robot_basics.checks import topic
from my_robot_basics.checks.topics import sampling
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from running import running

TOPIC = '/kinematics/joint_states'


def main(runs: int = 5) -> None:
    """Print a line for each run, then the medians."""
    classroom.enter()  # the node inherits the domain
    with running('five_hz'):
        took = [_minute() for _ in range(runs)]
    met, driven, used = map(statistics.median, zip(*took, strict=True))
    print(
        f'Median {met:.2f} s to meet the node, {driven:.2f} s for the minute, {used:.3f} s of CPU'
    )


def _minute() -> tuple[float, float, float]:
    """Return the seconds to discover the node, to record a minute of it, and of CPU for both."""
    cpu, began = time.process_time(), time.perf_counter()
    with Watcher(shared=True) as watcher:
        recorder = topic(TOPIC).listen(watcher)
        met = time.perf_counter()
        recording = sampling.record_simulated(watcher, recorder, seconds=60.0, step_sec=0.1)
        driven = time.perf_counter() - met
    used = time.process_time() - cpu
    count = len(recording.messages)
    print(f'{count} of 300 messages on the {recording.clock} clock in {driven:.2f} s')
    alive = topic(TOPIC).wait_for(timeout_sec=2.0)
    print(f'  then alive on wall time: a stamp of {time.time() - _sec(alive):.2f} s ago')
    return met - began, driven, used


def _sec(message: object) -> float:
    stamp = message.header.stamp
    return stamp.sec + stamp.nanosec * 1e-9


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
