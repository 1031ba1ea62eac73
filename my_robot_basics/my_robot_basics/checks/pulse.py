"""Whether a node goes on while something else takes its time, by a topic on which it counts.

A machine that is short of time is no node that waits. On the clock that the check drives, only
ticks count that the node has acknowledged. On the wall clock, only time counts in which no process
waited for a processor, and the notebook has to answer questions meanwhile.
"""

from my_robot_basics.checks.clock import Inconclusive, SimulatedClock
from my_robot_basics.checks.ears import Ears
from my_robot_basics.exchange import student
from my_robot_basics.graph.watcher import CROWDED_TIMES, Watcher
from my_robot_basics.session.pressure import Stopwatch

STEP_NS = 100_000_000
TICKS = 20
"""Steps of the robot's clock: two of its seconds."""
MOST_TICKS_STILL = 5
"""Who counts at 10 Hz is silent for no longer."""
BEATS = 12
"""So many on the wall clock are enough; …"""
STILL_SEC = 0.8
"""… a silence is so long, of time that was free, and …"""
LOOKS = 8
"""… holds so many questions that the notebook answered."""
LOOK_SEC = 0.1


class Pulse:
    """A topic on which a node counts at 10 Hz while it is alive."""

    def __init__(self, watcher: Watcher, ears: Ears) -> None:
        self._watcher, self._ears = watcher, ears

    def goes_on(self) -> bool:
        """Whether it counts now: over two seconds of the robot's clock, or on the wall clock."""
        return self._ticks() or self._beats()

    def _ticks(self) -> bool:
        """Whether it counts on the robot's clock; False proves nothing."""
        try:
            with SimulatedClock(self._watcher, needed=set(self._ears.publishers())) as clock:
                still = 0
                for _ in range(TICKS):
                    before = len(self._ears.heard)
                    clock.tick(STEP_NS)
                    still = 0 if len(self._ears.heard) > before else still + 1
                    if still > MOST_TICKS_STILL:
                        return False
        except Inconclusive:
            return False
        return True

    def _beats(self) -> bool:
        """Whether it counts on the wall clock, without a silence among the first BEATS."""
        began = len(self._ears.heard)
        while len(self._ears.heard) - began < BEATS:
            if self._is_silent():
                return False
        return True

    def _is_silent(self) -> bool:
        """Whether no beat comes for so long; it returns at a beat."""
        before, watch = len(self._ears.heard), Stopwatch()
        looks = 0
        while len(self._ears.heard) == before:
            self._watcher.spin_until(lambda: len(self._ears.heard) > before, timeout_sec=LOOK_SEC)
            student.times_raised('')  # its process has had a turn when that is answered
            looks += 1
            is_crowded_out = watch.wall_sec() >= CROWDED_TIMES * STILL_SEC
            if looks >= LOOKS and (watch.free_sec() >= STILL_SEC or is_crowded_out):
                return len(self._ears.heard) == before
        return False
