"""Record a topic on the clock that the check drives."""

from dataclasses import replace

from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.checks.clock.inconclusive import Inconclusive, TooSlow
from my_robot_basics.checks.recordings import rates
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.topics.driven_topic import DrivenTopic
from my_robot_basics.checks.topics.drives import (
    FINE_PARTS,
    FINER_BELOW_SEC,
    SECONDS_ENOUGH,
    drive,
    prove,
)
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

HOLD_SEC = 1.0
UNEVEN = 'its messages are not evenly spaced'
COUNTS = "it counts the calls of a timer that is faster than the clock's steps"
CLOSER = (1.0, 0.1)
"""The recording is tried with these parts of the steps and of the time that are asked for. The
second detects nodes that count the calls of a timer faster than the clock's steps."""
SECONDS_LEAST = 2.0
"""The shortest recording. A drive that waits for threads records only this much at first: a node
that remembers when it published last is silent later until the wall clock has caught up."""
PATTERN_SEC = 6.0
"""Long enough to show a pattern: alternating gaps, or several messages at once each second."""
PATTERN_STEP_SEC, STEPS_APART = 0.01, 4
"""With steps below FINER_BELOW_SEC, `_record_pattern` records only if they are at least
PATTERN_STEP_SEC and messages at least STEPS_APART steps apart: otherwise, the wall clock is as
quick."""


def record_simulated(
    watcher: Watcher,
    recorder: Recorder,
    *,
    seconds: float,
    step_sec: float,
    hold_sec: float = HOLD_SEC,
) -> Recording | Inconclusive:
    """A recording on the robot's clock, or the reason why there is none.

    The reason is TooSlow only if the machine is busy. `hold_sec`: for how much wall time the clock
    stands still, to see whether the node ignores it.
    """
    watch = Stopwatch()
    try:
        with SimulatedClock(watcher, needed=set(recorder.publishers())) as clock:
            topic = DrivenTopic(watcher, recorder, clock, hold_sec=hold_sec)
            try:
                found = _record_in_steps(topic, seconds=seconds, step_sec=step_sec)
            except TooSlow:
                topic.expect_follows()
                raise
            if isinstance(found, Inconclusive) or rates.leaves_out(found):
                topic.expect_follows()
            if isinstance(found, Inconclusive):
                return _record_patiently(topic, found, seconds=seconds, step_sec=step_sec)
            return found
    except TooSlow as why:
        return why if watch.is_busy() else Inconclusive(str(why))
    except Inconclusive as why:
        return why


class Uneven(Inconclusive):
    """Messages that are not evenly spaced."""

    def __init__(self, recording: Recording) -> None:
        """`recording` has the messages."""
        super().__init__(UNEVEN)
        self.recording = recording


def _record_patiently(
    topic: DrivenTopic, first: Inconclusive, *, seconds: float, step_sec: float
) -> Recording | Inconclusive:
    """Record again and wait for threads after each tick, after a recording without a result.

    It is short at first, and as long as asked for only if that succeeds: afterwards a thread may
    have to wait until the wall clock has caught up with this one.
    """
    topic.wait_for_threads()
    if isinstance(first, Uneven) and (shown := _record_pattern(topic, first, step_sec=step_sec)):
        return shown
    found = _record_in_steps(topic, seconds=SECONDS_LEAST, step_sec=step_sec)
    if isinstance(found, Inconclusive) or seconds <= SECONDS_LEAST:
        return found
    return _record_in_steps(topic, seconds=min(seconds, SECONDS_ENOUGH), step_sec=step_sec)


def _record_in_steps(
    topic: DrivenTopic, *, seconds: float, step_sec: float
) -> Recording | Inconclusive:
    for part in CLOSER:
        recording = drive(
            topic, seconds=max(seconds * part, SECONDS_LEAST), step_sec=step_sec * part
        )
        if rates.leaves_out(recording):
            return recording
        if recording.is_over or not rates.is_even(recording):
            return Uneven(recording)  # perhaps a thread was late: see `_record_patiently`
        proof = prove(topic, recording)
        if proof is None:
            topic.expect_follows()  # beside the timer, a thread may publish on the wall clock
            continue
        if not rates.is_nearly_even(proof):
            return Uneven(recording)
        return replace(recording, proof=proof)
    return Inconclusive(COUNTS)


def _record_pattern(topic: DrivenTopic, first: Uneven, *, step_sec: float) -> Recording | None:
    """A recording of a pattern that no timer makes, with a proof in finer steps, or None.

    None if the first recording has no pattern, or if recording on the wall clock is as quick.
    """
    seen = first.recording
    if not _shows_soon(seen) or rates.pattern_in(seen) is None:
        return None
    recording, finer = (
        drive(topic, seconds=PATTERN_SEC, step_sec=step_sec / parts) for parts in (1, FINE_PARTS)
    )
    shown = replace(recording, proof=finer)
    return shown if rates.pattern_of(shown) else None


def _shows_soon(seen: Recording) -> bool:
    if seen.step_sec >= FINER_BELOW_SEC:
        return True
    is_rare = seen.rate_hz * seen.step_sec * STEPS_APART <= 1.0
    return is_rare and seen.step_sec >= PATTERN_STEP_SEC
