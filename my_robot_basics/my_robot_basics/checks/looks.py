"""The two ways to record a topic: on the clock that the check drives, and on the wall clock."""

import time
from collections.abc import Callable
from typing import Any

from rclpy.qos import QoSProfile

from my_robot_basics.checks import graphs, rates
from my_robot_basics.checks.clock import Inconclusive, SimulatedClock
from my_robot_basics.checks.recording import Recording, Sample
from my_robot_basics.checks.watcher import Watcher

HOLD_SEC = 1.0
WALL_SEC = 4.0
FIRST_MESSAGE_SEC = 20.0
IGNORES = 'the node ignores the clock'
FINER = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
"""Steps of the clock, as parts of the one asked for, tried until messages skip a tick."""
PROOF_PARTS = 5
"""The proof takes steps of this part of the recording's …"""
PROOF_STEPS = 20
"""… for at least so many of the recording's steps."""

Again = Callable[[str, float], Recording]
"""Makes one more recording on the wall clock, of so many seconds, for the reason given."""


class Ears:
    """A subscription that keeps every message with the wall time at which it was sent."""

    def __init__(
        self, watcher: Watcher, *, topic_name: str, type_: type, qos_profile: QoSProfile
    ) -> None:
        self.topic_name = topic_name
        self.type = type_
        self.heard: list[tuple[Any, int]] = []
        self._node = watcher.node
        self._subscription = self._node.create_subscription(
            type_, topic_name, self._hear, qos_profile
        )
        self._publishers = ()

    def is_connected(self) -> bool:
        """Whether a publisher has been met."""
        return self._subscription.get_publisher_count() > 0

    def publishers(self) -> tuple[str, ...]:
        """Full names of the nodes that publish on the topic, one for each publisher.

        The most that were ever seen: one may have gone when the recording ends.
        """
        infos = graphs.publisher_infos(self._node, self.topic_name)
        now = tuple(sorted(graphs.full_name(info) for info in infos))
        self._publishers = max(now, self._publishers, key=len)
        return self._publishers

    def messages(self) -> list[Any]:
        """The messages heard so far."""
        return [message for message, _ in self.heard]

    def count_since(self, wall_ns: int) -> int:
        """How many messages were sent after that wall time."""
        return sum(sent_ns > wall_ns for _, sent_ns in self.heard)

    def _hear(self, message: Any, info: dict) -> None:
        self.heard.append((message, info['source_timestamp']))


def simulated(
    watcher: Watcher, ears: Ears, *, seconds: float, step_sec: float, again: Again
) -> Recording | str:
    """A recording on the robot's clock, or a clause that says why there is none."""
    try:
        with SimulatedClock(watcher, needed=set(ears.publishers())) as clock:
            _hold(watcher, ears, clock)
            recording = _drive(ears, clock, seconds=seconds, step_sec=step_sec, again=again)
            if not rates.is_even(recording):
                return 'its messages are not evenly spaced'
            _prove(ears, clock, recording)
    except Inconclusive as why:
        return str(why)
    return recording


def wall(
    watcher: Watcher,
    ears: Ears,
    *,
    why: str,
    seconds: float = WALL_SEC,
    again: Again | None = None,
) -> Recording:
    """A recording of `seconds` on the wall clock, beginning at a message."""
    began_ns = time.time_ns()
    if watcher.spin_until(lambda: ears.count_since(began_ns) > 0, timeout_sec=seconds):
        watcher.late_sec = 0.0
        watcher.spin_for(seconds)
    sent = [(message, sent_ns) for message, sent_ns in ears.heard if sent_ns > began_ns]
    start_ns = sent[0][1] if sent else began_ns
    samples = [
        Sample(message, (sent_ns - start_ns) / 1e9, sent_ns / 1e9)
        for message, sent_ns in sent
        if sent_ns <= start_ns + seconds * 1e9
    ]
    return Recording(
        topic_name=ears.topic_name,
        messages=tuple(samples[1:]),
        clock='wall',
        publishers=ears.publishers(),
        seconds=seconds,
        start_sec=start_ns / 1e9,
        note=_note(ears, why),
        late_sec=watcher.late_sec,
        look_again=again and (lambda longer: again(why, longer)),
    )


def _note(ears: Ears, why: str) -> str:
    if why != IGNORES:
        return ''
    name = ', '.join(ears.publishers())
    return f"note: {name} ignores the robot's clock (use_sim_time); judged on the wall clock"


def _hold(watcher: Watcher, ears: Ears, clock: SimulatedClock) -> None:
    """The clock stands still: a node that keeps publishing does not follow it."""
    began_ns = time.time_ns()
    end = time.monotonic() + HOLD_SEC
    while time.monotonic() < end:
        clock.hold(0.05)
        if ears.count_since(began_ns) >= 2:
            raise Inconclusive(IGNORES)


def _drive(
    ears: Ears, clock: SimulatedClock, *, seconds: float, step_sec: float, again: Again
) -> Recording:
    step_ns, start_ns = _find_step(ears, clock, step_sec=step_sec)
    for _ in range(round(seconds * 1e9 / step_ns)):
        clock.tick(step_ns)
    samples = [
        Sample(message, (clock.time_ns(sent_ns) - start_ns) / 1e9, sent_ns / 1e9)
        for message, sent_ns in ears.heard
        if clock.time_ns(sent_ns) > start_ns
    ]
    return Recording(
        topic_name=ears.topic_name,
        messages=tuple(samples),
        clock='simulated',
        publishers=ears.publishers(),
        seconds=seconds,
        start_sec=start_ns / 1e9,
        step_sec=step_ns / 1e9,
        look_again=lambda longer: again('', longer),
    )


def _find_step(ears: Ears, clock: SimulatedClock, *, step_sec: float) -> tuple[int, int]:
    """A step that skips no period of the timer, and the time of the message to begin at.

    A timer fires once a tick at most, so messages in two ticks running ask for a finer step.
    """
    for part in FINER:
        step_ns = round(step_sec * part * 1e9)
        _tick_to_message(ears, clock, step_ns=step_ns)
        if _tick_to_message(ears, clock, step_ns=step_ns) > 1:
            break
    return step_ns, clock.now_ns


def _prove(ears: Ears, clock: SimulatedClock, recording: Recording) -> None:
    """See the same period in finer steps, too. Raises Inconclusive.

    A timer fires once a tick at most. One that is faster than the ticks, and publishes every so
    many calls, shows a period that the steps have made.
    """
    step_ns = round(recording.step_sec * 1e9 / PROOF_PARTS)
    _tick_to_message(ears, clock, step_ns=step_ns)
    ticks = messages = 0
    while ticks < PROOF_STEPS * PROOF_PARTS:
        ticks += _tick_to_message(ears, clock, step_ns=step_ns)
        messages += 1
    recorded_ns = messages * 1e9 / recording.rate_hz
    unsure_ns = step_ns + messages * recording.step_sec * 1e9 / len(recording.messages)
    if abs(ticks * step_ns - recorded_ns) > 1.5 * unsure_ns:
        raise Inconclusive("it counts the calls of a timer that is faster than the clock's steps")


def _tick_to_message(ears: Ears, clock: SimulatedClock, *, step_ns: int) -> int:
    """Tick until a message arrives; how many ticks it took. Raises Inconclusive."""
    before = len(ears.heard)
    for ticks in range(1, round(FIRST_MESSAGE_SEC * 1e9 / step_ns) + 1):
        clock.tick(step_ns)
        if len(ears.heard) > before:
            return ticks
    raise Inconclusive(f"no message came in {FIRST_MESSAGE_SEC:g} s of the robot's time")
