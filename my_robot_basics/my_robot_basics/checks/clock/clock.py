"""The robot's clock, driven by a check: switch nodes to `/clock`, hold it, step it, switch back.

`/clock` moves one acknowledged tick at a time, so that timers fire exactly, however busy the
machine is. If a node doesn't follow, Inconclusive is raised, and the wall clock decides.
"""

import bisect
import time
from collections.abc import Callable, Iterable
from typing import Self

from rcl_interfaces.srv import SetParameters
from rclpy.client import Client
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.task import Future
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from my_robot_basics.checks.clock.barriers import SLOWEST_BARRIER_SEC, Barriers
from my_robot_basics.checks.clock.clock_budget import ClockBudget
from my_robot_basics.checks.clock.clock_use import ANOTHERS, expect_wall_clock, why_not_driven
from my_robot_basics.checks.clock.inconclusive import Inconclusive, TooSlow
from my_robot_basics.checks.clock.parameter_services import (
    is_refused,
    nodes_with_services,
    set_use_sim_time,
)
from my_robot_basics.graph.watcher import Watcher

FIRST_ANSWER_SEC = 1.0
"""How long a node may take to answer at first, in s of free time: a busy machine is slow."""
RESTORE_SEC = 10.0
LONG_SEC = 3.0
"""A node that needs more free time than this to be driven is slow: a tick of some rclpy nodes with
several threads takes 7 ms."""
HELD_EVERY_SEC = 0.02
_NO_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
"""No event handlers: each would slow down every pass of the executor, and none is needed."""
_latest_ns = 0
"""The latest time on `/clock`: if a clock began earlier, nodes would wait for a time again."""


def ahead_sec() -> float:
    """How far the latest time on `/clock` is ahead of the wall clock, in seconds; 0 if it is not.

    Back on wall time, a node that remembers when it published last is silent for so long.
    """
    return max(0.0, (_latest_ns - time.time_ns()) / 1e9)


class SimulatedClock:
    """A context manager that publishes `/clock` for the nodes that accept `use_sim_time`.

    At the end, even after an exception, each node gets its former `use_sim_time` back.
    """

    def __init__(self, watcher: Watcher, *, needed: set[str]) -> None:
        """`needed`: full names of the nodes that have to follow, or Inconclusive is raised."""
        self._watcher = watcher
        self._needed = needed
        self._budget = ClockBudget()
        self._former: dict[str, bool] = {}
        self._barriers = Barriers(watcher)
        self._setters: dict[str, Client] = {}
        self._tick_ns: list[int] = []
        self._tick_wall_ns: list[int] = []
        self.now_ns = 0

    def __enter__(self) -> Self:
        """Switch the nodes to `/clock`, which begins no earlier than now. Raises Inconclusive."""
        node = self._watcher.node
        if why := why_not_driven(node):
            raise Inconclusive(why)
        best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._publisher = node.create_publisher(
            Clock, '/clock', best_effort, event_callbacks=_NO_EVENTS
        )
        try:
            self._switch()
        except BaseException:
            self._restore()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """Switch the nodes back to their former clocks."""
        self._restore()

    def hold(self, seconds: float) -> None:
        """Hold the clock for `seconds` of wall time, and publish the same time again and again."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._publish()
            self._watcher.spin_for(min(left, HELD_EVERY_SEC))

    def tick(self, step_ns: int, *, until: Callable[[], bool] | None = None) -> None:
        """Move the clock and wait until every node has handled the tick. Raises Inconclusive.

        A node's executor takes the tick in one pass and fires its timers in the next, and it
        answers one request per pass: the second answer shows that both are over. With a single
        node, so does the message of its timer: if `until()` is true soon, no request is sent.
        """
        self.show(self.now_ns + step_ns)
        if until is None or not self._barriers.wait_for(until):
            self.acknowledge()
        self._expect_time_left()

    def show(self, time_ns: int) -> None:
        """Move the clock to a time, and do not wait for the nodes."""
        self.now_ns = time_ns
        self._tick_ns.append(time_ns)
        self._tick_wall_ns.append(time.time_ns())
        self._publish()

    def time_ns(self, wall_ns: int) -> int:
        """What `/clock` showed at a wall time (a source timestamp), in ns; 0 before it began."""
        tick = bisect.bisect_right(self._tick_wall_ns, wall_ns) - 1
        return self._tick_ns[tick] if tick >= 0 else 0

    def takes_long(self) -> bool:
        """Whether to record less: the node is slow, or half of the budget is used."""
        if self._budget.wall_sec() <= LONG_SEC:
            return False
        return self._budget.free_sec() > LONG_SEC or self._budget.is_used(0.5)

    def _expect_time_left(self) -> None:
        if self._watcher.node.count_publishers('/clock') > 1:
            raise Inconclusive(ANOTHERS)
        if self._budget.is_used(1.0):
            within_sec = self._budget.wall_sec()
            raise TooSlow(f'the clock could not be driven within {within_sec:.0f} s')

    def _publish(self) -> None:
        self._publisher.publish(Clock(clock=Time(nanoseconds=self.now_ns).to_msg()))

    def acknowledge(self, questions: int = 2) -> None:
        """Wait until every node has answered so many requests. Raises Inconclusive."""
        self._barriers.acknowledge(questions)

    def _switch(self) -> None:
        """Turn `use_sim_time` on for every node that answers, and begin to publish `/clock`."""
        node = self._watcher.node
        self._watcher.spin_until_free(
            lambda: self._needed <= nodes_with_services(node), free_sec=FIRST_ANSWER_SEC
        )
        clients = []
        for name in nodes_with_services(node):
            self._setters[name] = node.create_client(SetParameters, f'{name}/set_parameters')
            clients += [*self._barriers.add(name), self._setters[name]]
            self._expect_time_left()
        self._watcher.spin_until_free(
            lambda: all(client.service_is_ready() for client in clients),
            free_sec=FIRST_ANSWER_SEC,
        )
        asked = self._barriers.ask()
        self._watcher.spin_until_free(_all_done(asked.values()), free_sec=FIRST_ANSWER_SEC)
        answered = {name: future.result() for name, future in asked.items() if future.done()}
        self._barriers.keep(answered)
        if not self._needed <= set(answered):
            has_them = self._needed <= nodes_with_services(node)
            why = TooSlow if has_them else Inconclusive
            raise why('its parameter services do not answer')
        self._former = {
            name: any(value.bool_value for value in reply.values)
            for name, reply in answered.items()
        }
        expect_wall_clock(self._former, self._needed)
        self.now_ns = max(time.time_ns(), _latest_ns)
        switched = set_use_sim_time(self._setters, dict.fromkeys(self._former, True))
        self._watcher.spin_until_free(_all_done(switched.values()), free_sec=FIRST_ANSWER_SEC)
        if any(is_refused(switched[name]) for name in self._needed):
            raise Inconclusive('it refuses use_sim_time')
        self._watcher.spin_until_free(self._is_subscribed_to, free_sec=FIRST_ANSWER_SEC)
        self._publish()
        self.acknowledge(questions=1)

    def _is_subscribed_to(self) -> bool:
        self._publish()
        return self._publisher.get_subscription_count() >= len(self._barriers)

    def _restore(self) -> None:
        global _latest_ns
        former, self._former = self._former, {}
        # rcl does not change the next call of a timer that is due at this very moment, so that it
        # would come only at that time; on a clock that goes back, all timers would start together
        self.now_ns = 1 + (self.now_ns or time.time_ns())
        _latest_ns = max(_latest_ns, self.now_ns)
        self._publish()
        asked = _all_done(self._barriers.ask(former).values())
        self._watcher.spin_until(asked, timeout_sec=SLOWEST_BARRIER_SEC)
        # wait long for a busy node: on a clock that is not driven any more, it would stand still
        restored = set_use_sim_time(self._setters, former)
        self._watcher.spin_until(_all_done(restored.values()), timeout_sec=RESTORE_SEC)
        self._watcher.node.destroy_publisher(self._publisher)


def _all_done(asked: Iterable[Future]) -> Callable[[], bool]:
    futures = [*asked]
    return lambda: all(future.done() for future in futures)
