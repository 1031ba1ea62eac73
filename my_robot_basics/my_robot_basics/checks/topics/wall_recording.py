"""Record a topic on the wall clock."""

import time

from my_robot_basics.checks.clock.clock import ahead_sec
from my_robot_basics.checks.clock.inconclusive import Inconclusive, NoMessage, TooSlow
from my_robot_basics.checks.recordings import rates
from my_robot_basics.checks.recordings.recorded_messages import Sample
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.feedback.errors import shorten
from my_robot_basics.feedback.hidden import is_quiet
from my_robot_basics.graph.stop_reasons import what_raised
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

WALL_SEC = 4.0

TIMEOUT_SEC = 7.0
"""How long to wait on the wall clock for a message, and for the next one: messages that are 5 s
apart are slow, but have not ended."""

RAISED_SEC = 2.0
"""The same if nothing has come yet and a callback raised: rclpy.spin would have ended there."""

GOES_ON_SEC = 4.0
"""How long messages must go on as before: with the first recording, for 9 s in all. A loop that
publishes forty times has ended by then, and its silence is longer than a timer's period."""

IGNORES = 'the node ignores the clock'


def record(
    watcher: Watcher,
    recorder: Recorder,
    *,
    why: Inconclusive | None = None,
    seconds: float = WALL_SEC,
    timeout_sec: float = TIMEOUT_SEC,
) -> Recording:
    """A recording of `seconds` on the wall clock, beginning at a message.

    It waits up to `timeout_sec` for this first message, plus the time until the wall clock has
    caught up with a driven one. If no second message comes within `seconds`, it waits up to
    `timeout_sec` for that, too, and ends there. `why`: the reason not to use the robot's clock.
    """
    has_raised = not recorder.received and what_raised(recorder.publishers())
    if has_raised:
        seconds = timeout_sec = RAISED_SEC
    # also if the node seemed to ignore the robot's clock: perhaps one of its threads was late
    is_ahead = not (has_raised or isinstance(why, NoMessage))

    def record() -> tuple[int, Stopwatch]:
        first_sec = timeout_sec + (ahead_sec() if is_ahead else 0.0)
        recorder.take_all()
        since_ns, watch = time.time_ns(), Stopwatch()
        if watcher.spin_until(lambda: recorder.count_since(since_ns) > 0, timeout_sec=first_sec):
            watcher.late_sec, watch = 0.0, Stopwatch()
            watcher.spin_for(seconds)
            watcher.spin_until(
                lambda: recorder.count_since(since_ns) > 1, timeout_sec=timeout_sec - seconds
            )
            recorder.take_all()  # if there are too many to keep up, they would seem to have ended
        return since_ns, watch

    since_ns, watch = record()
    if is_ahead and ahead_sec() and recorder.count_since(since_ns) == 1:
        # a change of the clock wakes a thread that sleeps until a time; its next message is later
        since_ns, watch = record()
    arrived = zip(recorder.received, recorder.offsets_ns, strict=True)
    sent = [(message, ns, offset_ns) for (message, ns), offset_ns in arrived if ns > since_ns]
    start_ns = sent[0][1] if sent else since_ns
    samples = [
        Sample(message, (sent_ns - start_ns) / 1e9, sent_ns / 1e9, offset_ns / 1e9)
        for message, sent_ns, offset_ns in sent[1:]
    ]
    next_sec = samples[0].time_sec if samples else timeout_sec
    seconds = max(seconds, next_sec)
    return Recording(
        topic_name=recorder.topic_name,
        messages=tuple(sample for sample in samples if sample.time_sec <= seconds),
        clock='wall',
        publishers=recorder.publishers(),
        hidden_publishers=recorder.hidden_publishers(),
        seconds=seconds,
        start_sec=start_ns / 1e9,
        note=_note(recorder) if str(why) == IGNORES else '',
        late_sec=watcher.late_sec,
        was_busy=watch.is_busy(),
        is_makeshift=isinstance(why, TooSlow),
    )


def remembers_sec(why: Inconclusive | None) -> float:
    """How long a node may be silent that remembers when it published last, on the robot's clock.

    0 if the node published nothing on that clock, or ignored it.
    """
    return 0.0 if isinstance(why, NoMessage) or str(why) == IGNORES else ahead_sec()


def goes_on(watcher: Watcher, recorder: Recorder, earlier: Recording) -> bool:
    """Whether messages still come as often and as evenly as in an earlier recording."""
    again = record(watcher, recorder, seconds=GOES_ON_SEC, timeout_sec=GOES_ON_SEC)
    return again.publishers == earlier.publishers and rates.has_rate(again, earlier.rate_hz)


def _note(recorder: Recorder) -> str:
    # in one line: each line would be a note; a node's name may tell of inputs that are hidden
    name = '…' if is_quiet() else shorten(', '.join(recorder.publishers()))
    return f"note: {name} ignores the robot's clock (use_sim_time); judged on the wall clock"
