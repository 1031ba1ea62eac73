"""Record a topic on the robot's clock, or else on the wall clock, and once more if in doubt."""

import time
from dataclasses import replace
from typing import NoReturn

from my_robot_basics.checks.clock.clock_use import are_left_alone
from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.checks.recordings import rates
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.topics import ignoring, sampling, wall_recording
from my_robot_basics.checks.topics.earlier_looks import Look, Wanted, look_once
from my_robot_basics.checks.topics.topic_endpoints import TopicEndpoints
from my_robot_basics.feedback.errors import CheckFailed, Disturbed, expect, fail
from my_robot_basics.feedback.hidden import is_in_test_room
from my_robot_basics.graph.stop_reasons import what_raised
from my_robot_basics.graph.watcher import Watcher

LATE_SEC = 0.02
"""A machine that delays a check by so much may also make a correct node miss a period."""
LATE_LOOKS = 2
"""How many more recordings are made on such a machine."""
VALIDATE_SEC = 28.0
"""How long all looks of one recording may take together: *Validate* gives a cell 30 s."""
GRADING_SEC = 60.0
"""The same in the grader, which gives a cell 150 s, for at most two recordings."""
BEFORE_SEC = 0.5
"""How long to wait for a message before the node's clock is changed, in seconds of free time."""


def record(topic: TopicEndpoints, wanted: Wanted, *, hold_sec: float) -> Recording:
    """Record the topic; see `Topic.record`. Raises CheckFailed."""
    start = time.monotonic()
    look = look_once(wanted, lambda earlier: _look(topic, wanted, hold_sec, earlier))
    left_sec = _looks_sec() - (time.monotonic() - start)
    return _to_look_again(topic, look, left_sec=left_sec, late_looks=LATE_LOOKS)


def _look(topic: TopicEndpoints, wanted: Wanted, hold_sec: float, earlier: Look | None) -> Look:
    with Watcher(shared=True, listens=True) as watcher:
        recorder = topic.listen(watcher)
        if earlier is not None and wall_recording.goes_on(watcher, recorder, earlier.recording):
            return earlier
        sent = watcher.spin_until_free(lambda: bool(recorder.received), free_sec=BEFORE_SEC)
        found = _simulated(watcher, recorder, wanted, hold_sec)
        if isinstance(found, Inconclusive):
            look = Look(wall_recording.record(watcher, recorder, why=found), found)
        else:
            look = Look(found, None)
        if not look.recording.messages:
            if earlier is not None:
                _fail_ended(recorder)
            if sent and not are_left_alone():
                _expect_ends_by_itself(recorder)
            topic.fail_silent(watcher, seen=f'no message in {look.recording.seconds:g} s')
        return look


def _simulated(
    watcher: Watcher, recorder: Recorder, wanted: Wanted, hold_sec: float
) -> Recording | Inconclusive:
    if ignoring.is_known(recorder):
        return Inconclusive(wall_recording.IGNORES)
    found = sampling.record_simulated(
        watcher,
        recorder,
        seconds=wanted.seconds,
        step_sec=wanted.step_sec,
        hold_sec=hold_sec,
    )
    if str(found) == wall_recording.IGNORES:
        ignoring.remember(recorder)
    return found


def _to_look_again(
    topic: TopicEndpoints, look: Look, *, left_sec: float, late_looks: int
) -> Recording:
    def look_again(seconds: float) -> Recording:
        # twice: waiting for the message at which it begins may take as long
        if left_sec < 2.0 * seconds + wall_recording.remembers_sec(look.why):
            raise CheckFailed('there is no time for another look')
        start = time.monotonic()
        with Watcher(shared=True, listens=True) as watcher:
            recorder = topic.listen(watcher)
            again = wall_recording.record(
                watcher, recorder, why=look.why, seconds=seconds, timeout_sec=seconds
            )
        if again.late_sec < LATE_SEC or not late_looks:
            return again
        left = left_sec - (time.monotonic() - start)
        return _to_look_again(
            topic, Look(again, look.why), left_sec=left, late_looks=late_looks - 1
        )

    return replace(look.recording, look_again=look_again)


def _fail_ended(recorder: Recorder) -> NoReturn:
    fail(
        expected=f'messages on {recorder.topic_name}',
        seen='some, and none any more',
        hint=rates.GOES_ON,
        cause='the messages end',
    )


def _expect_ends_by_itself(recorder: Recorder) -> None:
    """Raise Disturbed if a node became silent on the robot's clock, and raised no exception."""
    expect(
        bool(what_raised(recorder.publishers())),
        expected=f'messages on {recorder.topic_name}',
        seen="some, and none any more once the node was on the robot's clock (use_sim_time)",
        hint='let no loop end when sleep_for returns False: it does so when the clock changes',
        cause='the messages end',
        doubt=Disturbed,
    )


def _looks_sec() -> float:
    return GRADING_SEC if is_in_test_room() else VALIDATE_SEC
