"""How many messages come a tick late, if a node is asked twice after each tick, or three times.

    .venv/bin/python tests/benchmarks/overtaken_ticks.py [TICKS] [--busy LOOPS]

A node's executor that begins to wait while a tick and a request arrive may see the request alone:
then it answers twice before it fires its timer. Beside busy loops this is more frequent. A check
asks three times where a message may come. Nothing is asserted.
"""

import argparse
import contextlib
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'nodes'))

from my_robot_basics.checks import topic
from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from running import running

TOPIC, NODE, PERIOD_SEC = '/kinematics/joint_states', '/kinematics_publisher', 0.2
STEP_NS = round(PERIOD_SEC * 1e9 / 5.5)
"""Every fifth or sixth tick brings a message, by turns."""
BUSY = [sys.executable, '-c', 'while True: pass']


def count_late(ticks: int, questions: int) -> tuple[int, int]:
    """Drive the clock of a 5 Hz node; return how many messages came, and how many were late."""
    with Watcher(shared=True) as watcher:
        recorder = topic(TOPIC).listen(watcher)
        with SimulatedClock(watcher, needed={NODE}) as clock:
            start_ns = clock.now_ns
            for _ in range(ticks):
                clock.show(clock.now_ns + STEP_NS)
                clock.acknowledge(questions)
            recorder.take_all()
            times_ns = [clock.time_ns(sent_ns) for _, sent_ns in recorder.received]
    came = np.array([each for each in times_ns if each > start_ns][1:])
    off = (came - came[0]) / STEP_NS - np.arange(len(came)) * PERIOD_SEC * 1e9 / STEP_NS
    # on time, messages are at most half a tick apart; a late one is a whole tick later
    return len(came), int(np.count_nonzero(off > np.quantile(off, 0.02) + 0.75))


def main(ticks: int, loops: int) -> None:
    """Print a line for each number of questions."""
    classroom.enter()  # the node inherits the domain
    with contextlib.ExitStack() as stack:
        for _ in range(loops):
            stack.callback(stack.enter_context(subprocess.Popen(BUSY)).kill)
        stack.enter_context(running('five_hz'))
        for questions in (2, 3):
            messages, late = count_late(ticks, questions)
            print(f'{questions} questions, {ticks} ticks: {late} of {messages} messages late')


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('ticks', type=int, nargs='?', default=5000)
    parser.add_argument('--busy', type=int, default=0, metavar='LOOPS')
    args = parser.parse_args()
    main(args.ticks, args.busy)
