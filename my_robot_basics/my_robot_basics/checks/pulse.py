"""Whether a node goes on while something else takes its time, by a topic on which it counts.

A machine that is short of time is no node that waits. On the clock that the check drives, only
ticks count that the node has acknowledged. On the wall clock, only time counts in which no process
waited for a processor, and the notebook has to answer questions meanwhile.
"""

from my_robot_basics.checks.clock import Inconclusive, SimulatedClock
from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.exchange import student
from my_robot_basics.graph.watcher import Watcher
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
"""… holds so many questions that the notebook answered. …"""
CROWDED_LOOKS = 40
"""… Where no time is free, so many prove that its process has its turns, and the node none."""
AGAIN_TIMES = 3
"""A second look takes so many times as much of all three."""
LOOK_SEC = 0.1


class Pulse:
    """A topic on which a node counts at 10 Hz while it is alive."""

    def __init__(self, watcher: Watcher, recorder: Recorder) -> None:
        self._watcher, self._recorder = watcher, recorder
        self._was_free = False

    def goes_on(self) -> bool:
        """Whether it counts now, on the wall clock.

        A silence without enough free time leaves a doubt: then two seconds of the robot's clock
        decide, or a longer look. They come later, for a clock that was driven, and given back, may
        keep a timer silent for as long as it was ahead.
        """
        if self._beats():
            return True
        return not self._was_free and (self._ticks() or self._beats(times=AGAIN_TIMES))

    def _ticks(self) -> bool:
        """Whether it counts on the robot's clock; False proves nothing."""
        try:
            with SimulatedClock(self._watcher, needed=set(self._recorder.publishers())) as clock:
                still = 0
                for _ in range(TICKS):
                    before = len(self._recorder.received)
                    clock.tick(STEP_NS)
                    still = 0 if len(self._recorder.received) > before else still + 1
                    if still > MOST_TICKS_STILL:
                        return False
        except Inconclusive:
            return False
        return True

    def _beats(self, *, times: int = 1) -> bool:
        """Whether it counts on the wall clock, without a silence among the first BEATS."""
        began = len(self._recorder.received)
        while len(self._recorder.received) - began < BEATS:
            if self._is_silent(times):
                return False
        return True

    def _is_silent(self, times: int) -> bool:
        """Whether no beat comes for so long; it returns at a beat."""
        before, watch, looks = len(self._recorder.received), Stopwatch(), 0
        while looks < times * CROWDED_LOOKS and (
            looks < times * LOOKS or watch.free_sec() < times * STILL_SEC
        ):
            if self._watcher.spin_until(
                lambda: len(self._recorder.received) > before, timeout_sec=LOOK_SEC
            ):
                return False
            student.times_raised('')  # its process has had a turn when that is answered
            looks += 1
        self._was_free = watch.free_sec() >= times * STILL_SEC
        return True
