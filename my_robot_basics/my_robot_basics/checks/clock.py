"""The robot's clock in the hands of a check: switch nodes to it, hold it, step it, give it back.

`/clock` moves one acknowledged tick at a time, so that what a timer does is exact however
loaded the machine is. A node that doesn't follow raises Inconclusive, and wall time decides.
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

from my_robot_basics.checks.barriers import SLOWEST_BARRIER_SEC, Barriers
from my_robot_basics.checks.clock_budget import ClockBudget
from my_robot_basics.checks.clock_use import ANOTHERS, why_not_driven
from my_robot_basics.checks.inconclusive import Inconclusive, TooSlow
from my_robot_basics.checks.parameter_services import (
    is_refused,
    nodes_with_services,
    set_use_sim_time,
)
from my_robot_basics.graph.watcher import Watcher

FIRST_ANSWER_SEC = 1.0
"""What a node may take to answer, of time that was free: an honest node on a busy machine is
slow, too."""
RESTORE_SEC = 10.0
LONG_SEC = 3.0
"""Of time that was free: whoever needs more to be driven is slow. A tick of some rclpy nodes with
several threads takes 7 ms."""
HELD_EVERY_SEC = 0.02
_NO_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
"""Each look of an executor costs more for every event; nobody waits for these."""
_latest_ns = 0
"""What `/clock` showed last: a node that waits for a time would else wait for it once more."""


def ahead_sec() -> float:
    """How far what `/clock` showed last is ahead of the wall clock, in seconds; 0 where not.

    So long is a node silent, back on wall time, that remembers when it published last.
    """
    return max(0.0, (_latest_ns - time.time_ns()) / 1e9)


class SimulatedClock:
    """A context manager that holds `/clock` for the nodes on the graph that let it.

    On leaving, whatever happened, each node gets its former `use_sim_time` back.
    """

    def __init__(self, watcher: Watcher, *, needed: set[str]) -> None:
        """`needed`: full names of the nodes without which the look is inconclusive."""
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
        """Switch the nodes to `/clock`, which starts no earlier than now. Raises Inconclusive."""
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
        """Switch them back."""
        self._restore()

    def hold(self, seconds: float) -> None:
        """Let the clock stand still for `seconds` of wall time, saying so all the while."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._publish()
            self._watcher.spin_for(min(left, HELD_EVERY_SEC))

    def tick(self, step_ns: int, *, until: Callable[[], bool] | None = None) -> None:
        """Move the clock and wait until every node has dealt with it. Raises Inconclusive.

        A node's executor takes the tick in one pass and fires its timers in the next, and it
        answers one question a pass: the second answer tells that both are over. So does, of a
        sole node, what its timer brings: where `until()` is true soon, nobody is asked.
        """
        self.show(self.now_ns + step_ns)
        if until is None or not self._barriers.wait_for(until):
            self.acknowledge()
        self._expect_time_left()

    def show(self, time_ns: int) -> None:
        """Move the clock to a time, and wait for nobody."""
        self.now_ns = time_ns
        self._tick_ns.append(time_ns)
        self._tick_wall_ns.append(time.time_ns())
        self._publish()

    def time_ns(self, wall_ns: int) -> int:
        """What `/clock` showed at a wall time (a message's source timestamp), in ns; 0 before."""
        tick = bisect.bisect_right(self._tick_wall_ns, wall_ns) - 1
        return self._tick_ns[tick] if tick >= 0 else 0

    def takes_long(self) -> bool:
        """Whether a shorter recording will do: the node is slow, or half of the time is gone."""
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
        """Wait until every node has answered so many questions. Raises Inconclusive."""
        self._barriers.acknowledge(questions)

    def _switch(self) -> None:
        """Turn `use_sim_time` on for every node that answers, and start `/clock` at wall time."""
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
        _latest_ns = max(_latest_ns, self.now_ns)
        former, self._former = self._former, {}
        # back to wall time first: rcl leaves a timer that is due this very moment where it is, and
        # in the future of wall time it would be silent until that has come
        self.now_ns = time.time_ns()
        self._publish()
        asked = _all_done(self._barriers.ask(former).values())
        self._watcher.spin_until(asked, timeout_sec=SLOWEST_BARRIER_SEC)
        # a busy node gets its time: left on a clock that nobody drives, it would be frozen
        restored = set_use_sim_time(self._setters, former)
        self._watcher.spin_until(_all_done(restored.values()), timeout_sec=RESTORE_SEC)
        self._watcher.node.destroy_publisher(self._publisher)


def _all_done(asked: Iterable[Future]) -> Callable[[], bool]:
    futures = [*asked]
    return lambda: all(future.done() for future in futures)
