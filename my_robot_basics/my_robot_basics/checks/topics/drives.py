"""Drive the robot's clock while a topic is recorded, and prove the period with other steps."""

import itertools

from my_robot_basics.checks.clock.inconclusive import NoMessage
from my_robot_basics.checks.recordings import rates
from my_robot_basics.checks.recordings.recorded_messages import Sample
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.topics.driven_topic import DrivenTopic

SECONDS_ENOUGH = 10.0
"""If driving the clock takes long, a recording of so many seconds is enough. A longer recording
begins with so many seconds in short steps."""
FINER = (1.0, 0.5, 0.1, 0.05, 0.01)
"""Steps of the clock to try, as parts of the given step, until some ticks bring no message.

Each is a multiple of all finer ones. Steps of 20 ms, and of 4 ms in the proof, would both turn a
period of 50 ms into 60 ms if a node looks at the clock every 10 ms."""
FINE_PARTS, FINER_PARTS, COARSE_TIMES = 2.5, 5, 5
"""The proof's step is the recording's, divided by one of the first two or times the third."""
TWO_STEPS_PARTS = 2.75
"""The divisor if the period is two of the recording's steps, which are no multiple of such a step.
A node that looks whether 0.17 s have passed publishes every 0.2 s, with steps of 0.1 s and of
0.04 s alike."""
FINER_BELOW_SEC = 0.05
"""For a step below this, the divisor is FINER_PARTS: 10 ms are a multiple of such steps, too."""
PROOF_STEPS = 30
"""The least length of a proof: so many of the recording's steps, or so many coarse steps."""
COARSE_STEPS = 4
"""Coarse steps are faster. They are used if at least so many of them fit in the period."""
KEEPS_UP_EVERY = 20
"""How many ticks are between two looks whether a callback takes longer than its period."""


def drive(topic: DrivenTopic, *, seconds: float, step_sec: float) -> Recording:
    """Record `seconds`, or longer until there are FEWEST messages. Raises Inconclusive.

    If the messages of the first SECONDS_ENOUGH are equally far apart, later ticks are as long as
    that; if one of them does not bring one message, the recording starts again. If driving the
    clock takes long, record less, so that there is time for the proof.
    """
    step_ns, start_ns = _find_step(topic, step_sec=step_sec)
    first_sec = min(seconds, SECONDS_ENOUGH)
    _tick(topic, start_ns, seconds=first_sec, step_ns=step_ns)
    if first_sec < seconds and not topic.clock.takes_long():
        long_ns = _distance_ns(topic, start_ns)
        if long_ns <= step_ns or not topic.expect_in_each_tick(long_ns):
            _tick(topic, start_ns, seconds=seconds, step_ns=step_ns)
        elif not _tick(topic, start_ns, seconds=seconds, step_ns=long_ns, by_message=True):
            start_ns = _start_again(topic, start_ns, seconds=seconds, step_ns=step_ns)
    while len(_times_ns(topic, start_ns)) < rates.FEWEST:
        topic.tick_to_message(step_ns)
    return _recorded(topic, start_ns=start_ns, step_ns=step_ns)


def _tick(
    topic: DrivenTopic, start_ns: int, *, seconds: float, step_ns: int, by_message: bool = False
) -> bool:
    """Tick until `seconds` have passed since `start_ns`, or enough if that takes long.

    Returns whether it did: with `by_message`, a tick ends it that does not bring one message.
    """
    clock = topic.clock
    ticks = round((start_ns + seconds * 1e9 - clock.now_ns) / step_ns)
    for done in range(1, ticks + 1):
        if topic.tick(step_ns) != 1 and by_message:
            return False
        if done % KEEPS_UP_EVERY == 0:
            topic.expect_keeps_up(KEEPS_UP_EVERY, step_ns)
            if clock.now_ns - start_ns >= SECONDS_ENOUGH * 1e9 and clock.takes_long():
                break
    return True


def _start_again(topic: DrivenTopic, start_ns: int, *, seconds: float, step_ns: int) -> int:
    """Record again in short steps from the next message on; return when that came.

    If none comes within the `seconds` since `start_ns`, the messages have ended: return that.
    """
    while topic.clock.now_ns < start_ns + seconds * 1e9:
        if topic.tick(step_ns):
            start_ns = topic.clock.now_ns
            _tick(topic, start_ns, seconds=seconds, step_ns=step_ns)
            break
    return start_ns


def _times_ns(topic: DrivenTopic, start_ns: int) -> list[int]:
    """The ticks of the messages since then, on the robot's clock."""
    times_ns = (topic.clock.time_ns(sent_ns) for _, sent_ns in topic.recorder.received)
    return [time_ns for time_ns in times_ns if time_ns > start_ns]


def _distance_ns(topic: DrivenTopic, start_ns: int) -> int:
    """How far apart the messages since `start_ns` are, if all distances are equal; otherwise 0."""
    distances = {b - a for a, b in itertools.pairwise([start_ns, *_times_ns(topic, start_ns)])}
    return distances.pop() if len(distances) == 1 else 0


def _recorded(topic: DrivenTopic, *, start_ns: int, step_ns: int) -> Recording:
    """What was received since `start_ns` of the robot's time."""
    recorder, clock = topic.recorder, topic.clock
    samples = [
        Sample(message, (clock.time_ns(sent_ns) - start_ns) / 1e9, sent_ns / 1e9)
        for message, sent_ns in recorder.received
        if clock.time_ns(sent_ns) > start_ns
    ]
    return Recording(
        topic_name=recorder.topic_name,
        messages=tuple(samples),
        clock='simulated',
        publishers=recorder.publishers(),
        hidden_publishers=recorder.hidden_publishers(),
        seconds=(clock.now_ns - start_ns) / 1e9,
        start_sec=start_ns / 1e9,
        step_sec=step_ns / 1e9,
    )


def _find_step(topic: DrivenTopic, *, step_sec: float) -> tuple[int, int]:
    """Find a step below the timer's period; return it, and the time of a message to begin at.

    A timer fires at most once in a tick, so messages in two ticks in a row call for a finer step.
    With a period of 1.25 ticks, every fourth gap has two ticks, but never two gaps in a row.
    """
    for part in FINER:
        step_ns = round(step_sec * part * 1e9)
        topic.tick_to_message(step_ns)
        ticks = topic.tick_to_message(step_ns)
        if ticks > 2 or (ticks == 2 and topic.tick_to_message(step_ns) > 1):
            break
    return step_ns, topic.clock.now_ns


def prove(topic: DrivenTopic, recording: Recording) -> Recording | None:
    """A recording with other steps that shows the same period, or None. Raises Inconclusive.

    A timer fires at most once in a tick. If a timer is faster than the ticks and publishes at
    every n-th call, the period depends on the steps.
    """
    step_ns = round(recording.step_sec * 1e9)
    parts: float = FINER_PARTS
    if recording.step_sec >= FINER_BELOW_SEC:
        is_two = abs(1.0 / (recording.rate_hz * recording.step_sec) - 2.0) < 0.1
        parts = TWO_STEPS_PARTS if is_two else FINE_PARTS
    coarse_ns, fine_ns = step_ns * COARSE_TIMES, round(step_ns / parts)
    is_slow = recording.rate_hz * COARSE_STEPS * coarse_ns <= 1e9
    coarse = is_slow and _same_period(topic, recording, coarse_ns, ticks_least=PROOF_STEPS)
    ticks_least = round(PROOF_STEPS * parts)
    return coarse or _same_period(topic, recording, fine_ns, ticks_least=ticks_least)


def _same_period(
    topic: DrivenTopic, recording: Recording, step_ns: int, *, ticks_least: int
) -> Recording | None:
    ticks = messages = 0
    try:
        topic.tick_to_message(step_ns)
        start_ns = topic.clock.now_ns
        while ticks < ticks_least:
            ticks += topic.tick_to_message(step_ns)
            messages += 1
    except NoMessage:
        return None
    recorded_ns = messages * 1e9 / recording.rate_hz
    unsure_ns = step_ns + messages * recording.step_sec * 1e9 / len(recording.messages)
    if abs(ticks * step_ns - recorded_ns) > 1.5 * unsure_ns:
        return None
    return _recorded(topic, start_ns=start_ns, step_ns=step_ns)
