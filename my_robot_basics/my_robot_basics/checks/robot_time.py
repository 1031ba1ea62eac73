"""The time in which a check watches a node: the robot's clock, step by step, or the wall clock."""

import time
from collections.abc import Callable

from my_robot_basics.checks.clock import SimulatedClock
from my_robot_basics.checks.inconclusive import Inconclusive
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

DUE_SEC = 0.05
"""How long to wait, of free time, for what a thread of the node is to do in a tick."""
MOST_FAILED_WAITS = 5
PUSH_NS, LONGEST_PUSH_NS = 500_000_000, 16_000_000_000
PUSH_SEC = 0.001
"""Steps of a clock that is only to come to an end, each twice as far as the one before up to the
longest, and how long each lasts."""
PUSHED_TIMES = 5
"""How much longer that may take on a busy machine."""
MOST_OFF_NS = 1_000_000_000
"""A node on this clock is never so far off it; one that nothing has reached yet shows 0."""


class WallTime:
    """The wall clock; of a wait, only time counts that was free.

    `DrivenTime` has the same attributes and methods.
    """

    is_driven = False
    step_ns = 0
    """How far a tick moves it; 0: it goes by itself."""

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher
        self._watch = Stopwatch()

    def now_ns(self) -> int:
        """The wall time, in ns."""
        return time.time_ns()

    def at_ns(self, wall_ns: int) -> int:
        """The time at a wall time, such as a message's source timestamp; both in ns."""
        return wall_ns

    def wait(self, done: Callable[[], bool], *, seconds: float) -> bool:
        """Spin until `done()`, for so many seconds that were free; whether it is done."""
        return self._watcher.spin_until_free(done, free_sec=seconds)

    def let_pass(self, done: Callable[[], bool], *, seconds: float) -> None:
        """Spin for so many seconds, or fewer if it is done before."""
        self._watcher.spin_until(done, timeout_sec=seconds)

    def wall_sec(self) -> float:
        """How long ago this was made."""
        return self._watch.wall_sec()

    def stalled_sec(self) -> float:
        """For how long processes had to wait for a processor since this was made."""
        return self._watch.wall_sec() - self._watch.free_sec()


class DrivenTime:
    """The robot's clock, in steps that the node acknowledges.

    A thread of the node that sleeps on this clock acknowledges nothing. `beat()` counts what it
    does, such as the feedback of an action: where that came every so many steps so far, the next
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
        """A beat came after so many steps lately; 0: nobody knows."""
        self._failed_waits = 0
        """How many more waits for a beat failed than not: if many, no such thread exists."""

    def now_ns(self) -> int:
        """What `/clock` shows, in ns."""
        return self._clock.now_ns

    def at_ns(self, wall_ns: int) -> int:
        """What it showed then."""
        return max(self._began_ns, self._clock.time_ns(wall_ns))

    def wait(self, done: Callable[[], bool], *, seconds: float) -> bool:
        """Step until `done()`, for so many seconds; whether it is done.

        Raises Inconclusive where the node does not follow.
        """
        end_ns = self.now_ns() + round(seconds * 1e9)
        while not done():
            if self.now_ns() + self.step_ns > end_ns:
                return False
            self._step()
        return True

    def let_pass(self, done: Callable[[], bool], *, seconds: float) -> None:
        """Step for so many seconds, or fewer if it is done before."""
        self.wait(done, seconds=seconds)

    def expect_shown(self, node_ns: int) -> None:
        """Raise Inconclusive where a node's clock showed another time just now.

        `/clock` is sent once: on a busy machine, a node that has just been switched may miss it.
        """
        if abs(node_ns - self.now_ns()) > MOST_OFF_NS:
            raise Inconclusive("the node's clock shows another time")

    def hold(self, seconds: float) -> None:
        """Let the clock stand still for so many seconds of wall time."""
        self._clock.hold(seconds)

    def push(self, done: Callable[[], bool], *, free_sec: float) -> bool:
        """Step without waiting for anybody until `done()`; whether that came in time.

        Time in which processes waited for a processor does not count, up to PUSHED_TIMES as much.
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
                self._clock.acknowledge()  # it has its turn to go to sleep again
        if (count := self._beat()) > self._last:
            self._every, self._silent_steps, self._last = self._silent_steps, 0, count
        elif is_due:
            self._every = 0
