"""How much a new subscription receives from a node of its notebook that has published 5,100 times.

    .venv/bin/python tests/benchmarks/late_subscriptions.py [PERIOD_SEC ...]

It prints, for each period and each of TIMES subscriptions, how many messages were published since
the subscription was made, and how many were received. Without the `data_reader` of
`session/fast_discovery.xml`, it shows what Fast DDS does by default. Nothing is asserted.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from live_lesson import Lesson

PERIODS_SEC = (0.2, 0.5, 1.0)
TIMES, MESSAGES = 8, 5
SETUP = """
import random
import time

from my_robot_basics.live import run, stop
from rclpy.node import Node
from std_msgs.msg import Int32


class Counter(Node):
    def __init__(self, period_sec):
        super().__init__('counter')
        self.count, self.publisher = 0, self.create_publisher(Int32, '/count', 10)
        self.create_timer(period_sec, self.tick)
        for _ in range(5100):
            self.tick()

    def tick(self):
        self.count += 1
        self.publisher.publish(Int32(data=self.count))


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.received = []
        self.create_subscription(Int32, '/count', self.received.append, 10)
"""
LISTEN = """
time.sleep(random.uniform(0.0, {period_sec}))
listener, before = run(Listener), counter.count
time.sleep(2.0 + {messages} * {period_sec})
print(counter.count - before, 'published,', len(listener.received), 'received')
stop(Listener)
"""


def main(periods_sec: list[float]) -> None:
    """Print a line for each subscription."""
    for period_sec in periods_sec:
        lesson = Lesson(SETUP, f'counter = run(Counter, {period_sec})\ntime.sleep(1.0)')
        for _ in range(TIMES):
            cell = lesson.send(LISTEN.format(period_sec=period_sec, messages=MESSAGES))
            lesson.wait_for(lambda cell=cell: cell.done, timeout_sec=120.0)
            print(f'every {period_sec} s: {cell.stdout.strip() or cell.error}', flush=True)
        lesson.shut_down()


if __name__ == '__main__':
    main([*map(float, sys.argv[1:])] or [*PERIODS_SEC])
