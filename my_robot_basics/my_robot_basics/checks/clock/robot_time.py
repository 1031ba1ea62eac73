"""The clock by which a check watches a node: the robot's clock, in steps, or the wall clock."""

import time
from collections.abc import Callable

from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

DUE_SEC = 0.05
"""How long to wait for what a thread of the node should do in a tick, in s of free time."""
MOST_FAILED_WAITS = 5
"""`DrivenTime` stops waiting for threads if this many more waits failed than succeeded."""
PUSH_NS, LONGEST_PUSH_NS = 500_000_000, 16_000_000_000
"""`push` doubles its steps, from PUSH_NS to LONGEST_PUSH_NS."""
PUSH_SEC = 0.001
"""The wall time between the steps of `push`."""
PUSHED_TIMES = 5
"""How many times as long `push` may take on a busy machine."""
HOLD_SEC = 0.05
"""`hold` looks after so much wall time whether it is done."""
MOST_OFF_NS = 1_000_000_000
"""A node on this clock never differs from it by more; before its first `/clock` it shows 0."""


class WallTime:
    """The wall clock; timeouts of `wait` count free time only.

    `DrivenTime` shares `is_driven`, `step_ns`, `now_ns`, `at_ns`, `wait` and `let_pass` with it.
    """

    is_driven = False
    step_ns = 0
    """How far a tick moves the clock; 0 because the wall clock moves by itself."""

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher
        self._watch = Stopwatch()

    def now_ns(self) -> int:
        """The wall time, in ns."""
        return time.time_ns()

    def at_ns(self, wall_ns: int) -> int:
        """Convert a wall time, such as a message's source timestamp, to this clock; in ns."""
        return wall_ns

    def wait(self, done: Callable[[], bool], *, seconds: float) -> bool:
        """Spin until `done()`, at most for `seconds` of free time; return whether it is done."""
        return self._watcher.spin_until_free(done, free_sec=seconds)

    def let_pass(self, done: Callable[[], bool], *, seconds: float) -> None:
        """Spin for `seconds` of wall time, or until `done()` if that is sooner."""
        self._watcher.spin_until(done, timeout_sec=seconds)

    def wall_sec(self) -> float:
        """The wall time since this object was created."""
        return self._watch.wall_sec()

    def stalled_sec(self) -> float:
        """How long processes had to wait for a processor since this object was created."""
        return self._watch.wall_sec() - self._watch.free_sec()


class DrivenTime:
    """The robot's clock, in steps that the node acknowledges.

    A thread of the node that sleeps on this clock acknowledges nothing. So `beat()` counts what it
    does, such as sending feedback of an action: if that happened every n steps so far, the n-th
    step waits for it.
    """

    is_driven = True

    def __init__(
        self, watcher: Watcher, clock: SimulatedClock, *, step_ns: int, beat: Callable[[], int]
    ) -> None:
        self._watcher, self._clock, self._beat = watcher, clock, beat
        self.step_ns = step_ns
        self._began_ns = clock.now_ns
        self._last = beat()
        self._silent_steps = 0
        self._every = 0
        """How many steps there were before the latest beat; 0 if unknown."""
        self._failed_waits = 0
        """Failed minus successful waits for a beat: if many, there is no such thread."""

    def now_ns(self) -> int:
        """The time that `/clock` shows, in ns."""
        return self._clock.now_ns

    def at_ns(self, wall_ns: int) -> int:
        """The time that `/clock` showed at that wall time; both in ns."""
        return max(self._began_ns, self._clock.time_ns(wall_ns))

    def wait(self, done: Callable[[], bool], *, seconds: float) -> bool:
        """Step until `done()`, at most for `seconds` of this clock; return whether it is done.

        Raises Inconclusive if the node does not follow the clock.
        """
        end_ns = self.now_ns() + round(seconds * 1e9)
        while not done():
            if self.now_ns() + self.step_ns > end_ns:
                return False
            self._step()
        return True

    def let_pass(self, done: Callable[[], bool], *, seconds: float) -> None:
        """Step for `seconds` of this clock, or until `done()` if that is sooner."""
        self.wait(done, seconds=seconds)

    def expect_shown(self, node_ns: int) -> None:
        """Raise Inconclusive if `node_ns`, the node's present time, differs from `/clock`.

        Each time is published once: on a busy machine, a node that has just been switched to this
        clock may miss it.
        """
        if abs(node_ns - self.now_ns()) > MOST_OFF_NS:
            raise Inconclusive("the node's clock shows another time")

    def hold(self, done: Callable[[], bool], *, free_sec: float, wall_sec: float) -> bool:
        """Let the clock stand still until `done()`; return whether it is done in time.

        It may take `free_sec` of free time, and no more than `wall_sec` of wall time: on a busy
        machine, a thread that ignores this clock may wait for a processor.
        """
        watch = Stopwatch()
        while not done():
            if watch.free_sec() >= free_sec or watch.wall_sec() >= wall_sec:
                return False
            self._clock.hold(HOLD_SEC)
        return True

    def push(self, done: Callable[[], bool], *, free_sec: float) -> bool:
        """Step without waiting for the node until `done()`; return whether it is done in time.

        It may take `free_sec` of free time, and PUSHED_TIMES as much wall time.
        """
        watch, step_ns = Stopwatch(), PUSH_NS
        while not done():
            if watch.free_sec() > free_sec or watch.wall_sec() > PUSHED_TIMES * free_sec:
                return False
            self._clock.show(self._clock.now_ns + step_ns)
            self._watcher.spin_for(PUSH_SEC)
            step_ns = min(2 * step_ns, LONGEST_PUSH_NS)
        return True

    def _step(self) -> None:
        self._clock.tick(self.step_ns)
        self._silent_steps += 1
        is_due = 0 < self._every <= self._silent_steps
        if is_due and self._beat() == self._last and self._failed_waits < MOST_FAILED_WAITS:
            came = self._watcher.spin_until_free(
                lambda: self._beat() > self._last, free_sec=DUE_SEC
            )
            self._failed_waits += -1 if came else 1
            if came:
                self._clock.acknowledge()  # this gives the thread time to sleep again
        if (count := self._beat()) > self._last:
            self._every, self._silent_steps, self._last = self._silent_steps, 0, count
        elif is_due:
            self._every = 0
