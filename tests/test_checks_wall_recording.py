"""Recordings on the wall clock: when they begin, how long they take, and what they wait for."""

import time
from dataclasses import replace
from types import SimpleNamespace

import pytest
from made_recordings import on_wall
from my_robot_basics.checks import CheckFailed, topic
from my_robot_basics.checks.clock.inconclusive import Inconclusive, NoMessage
from my_robot_basics.checks.recordings import recording as recording_module
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.topics import looks, sampling, topic_endpoints, wall_recording
from my_robot_basics.graph.watcher import Watcher
from nodes.running import running

TOPIC = '/kinematics/joint_states'


@pytest.mark.starts
@pytest.mark.slow
@pytest.mark.usefixtures('patient')
def test_the_first_recording_decides_if_the_node_has_ended(monkeypatch):
    with running('too_slow'):
        recording = topic(TOPIC).record(seconds=10.0)
    monkeypatch.setattr(topic_endpoints, 'PUBLISHER_SEC', 1.0)
    with pytest.raises(CheckFailed, match=r'saw 4\.(75|8) Hz over 10 s \(47 messages\)'):
        recording.assert_rate(hz=5.0)


@pytest.mark.starts
@pytest.mark.slow
@pytest.mark.parametrize(
    ('late_sec', 'validate_sec', 'looks_in_all'),
    [(0.0, 1000.0, 2), (1.0, 1000.0, 4), (1.0, 0.0, 1)],
)
def test_a_late_machine_records_again_while_there_is_time(
    monkeypatch, late_sec, validate_sec, looks_in_all
):
    recorded = []
    monkeypatch.setattr(looks, 'VALIDATE_SEC', validate_sec)

    def wall(*args, **options):
        recorded.append(replace(on_wall(*args, **options), late_sec=late_sec))
        return recorded[-1]

    on_wall = wall_recording.record
    monkeypatch.setattr(wall_recording, 'record', wall)
    monkeypatch.setattr(recording_module, 'SECOND_LOOK_SEC', 1.0)
    with running('unresponsive'):
        recording = topic(TOPIC).record()
        with pytest.raises(CheckFailed, match=r'expected 4\.0 Hz on .*, saw \d'):
            recording.assert_rate(hz=4.0)
    assert len(recorded) == looks_in_all


@pytest.mark.starts
def test_messages_not_yet_taken_by_the_check_are_in_the_recording(monkeypatch):
    """The check has no time on a busy machine, or if a publisher with a period of 0 floods it."""
    with running('fifty_hz'), Watcher() as watcher:
        recorder = topic(TOPIC).listen(watcher)
        # longer than it is asked for: what was sent within that time has then arrived
        monkeypatch.setattr(watcher, 'spin_for', lambda seconds: time.sleep(seconds + 1.0))
        # it ends between two messages: one at its end would be in it or not by rounding
        recording = wall_recording.record(watcher, recorder, seconds=2.01)
        recorder.take_all()
    until_sec = recording.start_sec + recording.seconds
    sent = [ns for _, ns in recorder.received if recording.start_sec < ns / 1e9 <= until_sec]
    assert len(recording.messages) == len(sent) > 20


def test_a_recording_waits_longer_for_a_node_that_seemed_to_ignore_the_clock(monkeypatch):
    """A thread that was late catches up while the clock stands still; its next time is ahead."""
    waited, why = [], Inconclusive(wall_recording.IGNORES)
    watcher = SimpleNamespace(late_sec=0.0)
    watcher.spin_until = lambda until, timeout_sec: waited.append(timeout_sec)
    recorder = object.__new__(Recorder)
    recorder.received, recorder.offsets_ns, recorder.topic_name = [(None, 0)], [0], TOPIC
    recorder.take_all = lambda: None
    recorder.publishers, recorder.hidden_publishers = (lambda: ('/a',)), tuple
    monkeypatch.setattr(wall_recording, 'ahead_sec', lambda: 30.0)
    wall_recording.record(watcher, recorder, why=why, timeout_sec=4.0)
    wall_recording.record(watcher, recorder, why=NoMessage('none'), timeout_sec=4.0)
    assert waited == [34.0, 4.0]


@pytest.mark.parametrize(('ahead_sec', 'count'), [(30.0, 20), (0.0, 0)])
def test_a_recording_does_not_begin_with_a_message_of_the_clock_change(
    monkeypatch, ahead_sec, count
):
    """`sleep_until` returns at once then, and a thread sleeps on until a time that is ahead."""
    now = SimpleNamespace(sec=100.0)
    times_sec = [100.1, *(100.0 + 30.0 + 0.2 * n for n in range(100))]
    watcher = SimpleNamespace(late_sec=0.0)
    recorder = object.__new__(Recorder)
    recorder.received, recorder.offsets_ns, recorder.topic_name = [], [], TOPIC
    recorder.publishers, recorder.hidden_publishers = (lambda: ('/a',)), tuple

    def take_all():
        while times_sec and times_sec[0] <= now.sec:
            recorder.received.append((None, round(times_sec.pop(0) * 1e9)))
            recorder.offsets_ns.append(0)

    def spin_until(done, timeout_sec):
        end_sec = now.sec + timeout_sec
        while not done() and now.sec < end_sec:
            now.sec = min(now.sec + 0.02, end_sec)
            take_all()
        return done()

    recorder.take_all, watcher.spin_until = take_all, spin_until
    watcher.spin_for = lambda seconds: spin_until(lambda: False, seconds)
    monkeypatch.setattr(wall_recording.time, 'time_ns', lambda: round(now.sec * 1e9))
    end_sec = now.sec + ahead_sec
    monkeypatch.setattr(wall_recording, 'ahead_sec', lambda: max(0.0, end_sec - now.sec))
    monkeypatch.setattr(wall_recording, 'what_raised', lambda names: '')
    recording = wall_recording.record(watcher, recorder, why=Inconclusive(sampling.UNEVEN))
    assert len(recording.messages) == count


@pytest.mark.parametrize(
    ('why', 'is_waited_for'),
    [
        (Inconclusive(sampling.UNEVEN), True),
        (NoMessage('no message arrived'), False),
        (Inconclusive(wall_recording.IGNORES), False),
    ],
    ids=['uneven', 'silent', 'ignores the clock'],
)
def test_only_a_node_that_published_on_the_simulated_clock_may_remember_it(
    monkeypatch, why, is_waited_for
):
    monkeypatch.setattr(wall_recording, 'ahead_sec', lambda: 30.0)
    assert wall_recording.remembers_sec(why) == (30.0 if is_waited_for else 0.0)


def looked_at(node, *, timeout_sec):
    with running(node), Watcher() as watcher:
        recorder = topic(TOPIC).listen(watcher)
        return wall_recording.record(watcher, recorder, seconds=0.1, timeout_sec=timeout_sec)


@pytest.mark.starts
def test_a_wall_recording_waits_for_the_next_message_of_a_slow_node():
    recording = looked_at('one_hz', timeout_sec=10.0)
    (sample,) = recording.messages
    assert sample.time_sec == recording.seconds > 0.1


@pytest.mark.starts
@pytest.mark.slow
@pytest.mark.parametrize(('timeout_sec', 'seconds'), [(0.4, 0.4), (0.0, 0.1)])
def test_a_wall_recording_without_messages_has_the_length_of_the_wait(timeout_sec, seconds):
    recording = looked_at('never_spins', timeout_sec=timeout_sec)
    assert (recording.messages, recording.seconds) == ((), seconds)


SLOWER = [0.23, 0.231] * 7


@pytest.mark.parametrize(('gaps_sec', 'goes_on'), [([0.2] * 15, True), (SLOWER, False)])
def test_a_recording_is_continued_only_if_the_rate_stays_the_same(monkeypatch, gaps_sec, goes_on):
    again, earlier = on_wall(gaps_sec, late_sec=0.0), on_wall([0.2] * 20, late_sec=0.0)
    monkeypatch.setattr(wall_recording, 'record', lambda *_, **__: again)
    assert wall_recording.goes_on(None, None, earlier) is goes_on


@pytest.mark.parametrize(
    ('times_said', 'passes'),
    [
        ([-0.001], True),
        ([-0.001] * 4 + [-0.4], True),
        ([-0.097, 0.1], False),
        ([-0.2, 0.0], False),
    ],
)
def test_messages_sent_in_pairs_are_not_evenly_spaced_by_the_times_that_they_say(
    times_said, passes
):
    """Each says a time near that at which it arrives; only the two of a pair are far apart."""
    recording, count = on_wall([0.2] * 20, late_sec=0.0), len(times_said)
    samples = [
        replace(sample, offset_sec=-times_said[i % count])
        for i, sample in enumerate(recording.messages)
    ]
    recording = replace(recording, messages=tuple(samples))
    if passes:
        recording._expect_true_times()
        return
    with pytest.raises(CheckFailed, match=r'that arrive when they are sent'):
        recording._expect_true_times()


@pytest.mark.parametrize('end', ['\n', '\r', '\x0b', '\x85', '\u2028'])
def test_a_node_name_with_line_ends_makes_a_note_of_one_line(end):
    """A note is a line of a check's: a student would write what a check has said."""
    recorder = SimpleNamespace(publishers=lambda: (f'/robot{end}note: 5 of 5 points',))
    assert len(wall_recording._note(recorder).splitlines()) == 1
