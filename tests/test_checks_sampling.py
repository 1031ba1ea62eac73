"""Rates of nodes that are no plain 5 Hz timers. One process a node, as at grading."""

import time
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import pytest
from my_robot_basics.checks import (
    CheckFailed,
    driven_topic,
    drives,
    looks,
    rates,
    sampling,
    topic,
    topic_endpoints,
    wall_recording,
)
from my_robot_basics.checks import recording as recording_module
from my_robot_basics.checks.clock import SimulatedClock
from my_robot_basics.checks.driven_topic import DrivenTopic
from my_robot_basics.checks.inconclusive import Inconclusive, NoMessage
from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.checks.recording import Recording, Sample
from my_robot_basics.feedback.errors import Starved
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch
from nodes.running import running

TOPIC = '/kinematics/joint_states'


@pytest.mark.parametrize(
    ('node', 'seen'),
    [
        ('one_hz', r'1\.0 Hz over 10 s \(10 messages\)'),
        ('too_slow', r'4\.7\d* Hz over 10 s'),
        ('too_fast', r'5\.2\d* Hz over 10 s'),
        # nearer than the wall clock could tell
        ('a_little_slow', r'4\.88 Hz over 10 s'),
        ('a_little_fast', r'5\.13 Hz over 10 s'),
        # 5 Hz in steps of 0.1 s, and of 0.04 s
        ('looks_too_early', r'5\.88 Hz over 2 s'),
    ],
)
@pytest.mark.usefixtures('patient')
def test_a_wrong_rate_fails(node, seen):
    with running(node):
        recording = topic(TOPIC).record(seconds=10.0)
        assert recording.clock == 'simulated'
        with pytest.raises(
            CheckFailed, match=rf'expected 5\.0 Hz, saw {seen}.*: the timer period'
        ):
            recording.assert_rate(hz=5.0)


@pytest.mark.slow
@pytest.mark.usefixtures('patient')
def test_a_timer_that_leaves_every_twentieth_out_fails_without_another_look(monkeypatch):
    monkeypatch.setattr(
        wall_recording, 'wall', lambda *_, **__: pytest.fail('looked at the wall clock')
    )
    with running('leaves_out'), pytest.raises(CheckFailed, match='one message of 20 missing each'):
        topic(TOPIC).record(seconds=60.0).assert_rate(hz=5.0)


@pytest.mark.slow
@pytest.mark.usefixtures('patient')
def test_on_a_busy_machine_the_clock_is_driven_for_a_shorter_time(monkeypatch):
    monkeypatch.setattr(SimulatedClock, 'takes_long', lambda clock: True)
    with running('well_equipped'):
        recording = topic(TOPIC).record(seconds=60.0)
        assert (recording.clock, recording.seconds) == ('simulated', 10.0)
        recording.assert_rate(hz=5.0)


@pytest.mark.slow
@pytest.mark.usefixtures('patient')
def test_the_first_look_stands_when_the_node_has_gone(monkeypatch):
    with running('too_slow'):
        recording = topic(TOPIC).record(seconds=10.0)
    monkeypatch.setattr(topic_endpoints, 'PUBLISHER_SEC', 1.0)
    with pytest.raises(CheckFailed, match=r'saw 4\.(75|8) Hz over 10 s \(47 messages\)'):
        recording.assert_rate(hz=5.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ('late_sec', 'validate_sec', 'looks_in_all'),
    [(0.0, 1000.0, 2), (1.0, 1000.0, 4), (1.0, 0.0, 1)],
)
def test_a_machine_that_is_late_itself_looks_again_while_there_is_time(
    monkeypatch, late_sec, validate_sec, looks_in_all
):
    recorded = []
    monkeypatch.setattr(looks, 'VALIDATE_SEC', validate_sec)

    def wall(*args, **options):
        recorded.append(replace(on_wall(*args, **options), late_sec=late_sec))
        return recorded[-1]

    on_wall = wall_recording.wall
    monkeypatch.setattr(wall_recording, 'wall', wall)
    monkeypatch.setattr(recording_module, 'SECOND_LOOK_SEC', 1.0)
    with running('unresponsive'):
        recording = topic(TOPIC).record()
        with pytest.raises(CheckFailed, match=r'expected 4\.0 Hz, saw \d'):
            recording.assert_rate(hz=4.0)
    assert len(recorded) == looks_in_all


@pytest.fixture
def held(monkeypatch):
    held, hold = [], DrivenTopic._hold

    def note_and_hold(driven, seconds):
        held.append(seconds)
        hold(driven, seconds)

    monkeypatch.setattr(DrivenTopic, '_hold', note_and_hold)
    return held


@pytest.mark.usefixtures('patient')
def test_who_may_ignore_the_clock_has_to_show_once_that_it_does(held):
    for node in 'five_hz', 'sleep_loop', 'five_hz':
        with running(node):
            topic(TOPIC).record(seconds=2.0)
            topic(TOPIC).record(seconds=2.0).assert_rate(hz=5.0)
    once = driven_topic.SETTLE_SEC
    assert held == [once, once, once, 1.0, once, once]


@pytest.mark.usefixtures('patient')
def test_all_messages_of_a_callback_are_taken_in_its_tick(monkeypatch):
    """Those that come one tick later would ask for ever finer steps."""
    tick, steps_sec = DrivenTopic.tick, []

    def note_and_tick(driven, step_ns):
        steps_sec.append(step_ns / 1e9)
        tick(driven, step_ns)

    monkeypatch.setattr(DrivenTopic, 'tick', note_and_tick)
    with running('bursts'), Watcher() as watcher:
        recorder = topic(TOPIC).listen(watcher)
        found = sampling.simulated(watcher, recorder, seconds=10.0, step_sec=0.1)
    assert str(found) == sampling.UNEVEN or rates.pattern_of(found).size == 5
    assert min(steps_sec) >= 0.1 / drives.FINE_PARTS


@pytest.mark.usefixtures('patient')
@pytest.mark.parametrize(
    ('node', 'seen'), [('bursts', '5 messages at once, every 1 s'), ('pairs', '2 .*, every 0.4 s')]
)
def test_bursts_leave_no_doubt_on_the_robots_clock(monkeypatch, node, seen):
    monkeypatch.setattr(wall_recording, 'wall', lambda *args, **options: pytest.fail('looked'))
    with running(node):
        recording = topic(TOPIC).record()
        with pytest.raises(CheckFailed, match=rf'saw {seen}, over 6 s \(30 messages\): publ'):
            recording.assert_rate(hz=5.0)
        recording.assert_stamps()


@pytest.mark.parametrize(
    ('step_sec', 'rate_hz', 'is_driven'),
    [
        (0.1, 10, True),
        (0.05, 40, True),
        # an old timer of 5 Hz beside one of 10 Hz, 13 ms later
        (0.01, 15, True),
        (0.01, 76, False),
        (0.005, 15, False),
    ],
)
def test_a_pattern_is_driven_where_that_is_sooner_than_the_wall_clock(
    monkeypatch, step_sec, rate_hz, is_driven
):
    driven = []

    def drive(_, *, seconds, step_sec):
        driven.append(step_sec)
        return seen

    monkeypatch.setattr(sampling, 'drive', drive)
    monkeypatch.setattr(sampling.rates, 'pattern_in', lambda _: 'a pattern')
    monkeypatch.setattr(sampling.rates, 'pattern_of', lambda _: 'a pattern')
    seen = replace(
        on_wall([1.0 / rate_hz] * 20, late_sec=0.0), clock='simulated', step_sec=step_sec
    )
    found = sampling._pattern(None, sampling.Uneven(seen), step_sec=0.1)
    assert (found is not None, len(driven)) == (is_driven, 2 * is_driven)


@pytest.mark.parametrize(
    ('sent_sec', 'ignores'),
    [
        # a timer that the jump of the clock sets off, and a callback that sends several
        ([0.0, 0.001, 0.015], False),
        # a thread that is late, and has some to send at first
        ([0.0, 0.02, 0.04], False),
        ([0.0, 0.04, 0.08], True),
    ],
)
def test_who_ignores_the_clock_goes_on_while_it_stands_still(ignores, sent_sec):
    began_ns = time.time_ns()
    recorder = object.__new__(Recorder)
    recorder.received = [(None, began_ns + round(sec * 1e9) + 1_000_000) for sec in sent_sec]
    driven = object.__new__(DrivenTopic)
    driven.recorder, driven.clock = recorder, SimpleNamespace(hold=time.sleep)
    with pytest.raises(Inconclusive, match=wall_recording.IGNORES) if ignores else nullcontext():
        driven._hold(0.1)


def test_what_nobody_had_time_to_take_has_come_all_the_same(monkeypatch):
    """A busy machine leaves the check none, or a publisher with a period of 0 sends too many."""
    with running('fifty_hz'), Watcher() as watcher:
        recorder = topic(TOPIC).listen(watcher)
        # longer than it is asked for: what was sent within that time has then arrived
        monkeypatch.setattr(watcher, 'spin_for', lambda seconds: time.sleep(seconds + 1.0))
        recording = wall_recording.wall(watcher, recorder, seconds=2.0)
        recorder.take_all()
    until_sec = recording.start_sec + recording.seconds
    sent = [ns for _, ns in recorder.received if recording.start_sec < ns / 1e9 <= until_sec]
    assert len(recording.messages) == len(sent) > 20


def test_who_works_for_longer_than_a_period_has_no_rate_on_the_robots_clock(monkeypatch):
    reasons, on_wall = [], wall_recording.wall

    def wall(*args, why=None, **options):
        reasons.append(str(why))
        return on_wall(*args, why=why, **options)

    monkeypatch.setattr(wall_recording, 'wall', wall)
    with running('overruns'), pytest.raises(CheckFailed, match=r'expected 5\.0 Hz, saw [34]\.'):
        topic(TOPIC).record().assert_rate(hz=5.0)
    assert reasons[0] == driven_topic.OVERRUNS


@pytest.mark.usefixtures('patient')
def test_the_clock_stands_still_before_finer_steps_prove_what_coarser_ones_do_not(held):
    with running('looks_too_early'):
        assert topic(TOPIC).record(seconds=10.0).clock == 'simulated'
    assert held == [driven_topic.SETTLE_SEC, 1.0]


def test_a_drive_in_vain_is_a_short_one_the_second_time(monkeypatch):
    asked = []

    def drive_in_vain(driven, *, seconds, step_sec):
        asked.append(seconds)
        return Inconclusive(sampling.UNEVEN)

    monkeypatch.setattr(sampling, '_sampled', drive_in_vain)
    with running('five_hz'):
        assert topic(TOPIC).record(seconds=10.0).clock == 'wall'
    assert asked == [10.0, 2.0]


def test_who_seemed_to_ignore_the_robots_clock_is_waited_for_like_who_remembers_it(monkeypatch):
    """A thread that was late catches up while the clock stands still; its next time is ahead."""
    waited, why = [], Inconclusive(wall_recording.IGNORES)
    watcher = SimpleNamespace(late_sec=0.0)
    watcher.spin_until = lambda until, timeout_sec: waited.append(timeout_sec)
    recorder = object.__new__(Recorder)
    recorder.received, recorder.topic_name = [(None, 0)], TOPIC
    recorder.take_all, recorder.publishers = (lambda: None), (lambda: ('/a',))
    monkeypatch.setattr(wall_recording, 'ahead_sec', lambda: 30.0)
    wall_recording.wall(watcher, recorder, why=why, timeout_sec=4.0)
    wall_recording.wall(watcher, recorder, why=NoMessage('none'), timeout_sec=4.0)
    assert waited == [34.0, 4.0]


@pytest.mark.parametrize(('ahead_sec', 'count'), [(30.0, 20), (0.0, 0)])
def test_a_message_of_the_change_of_its_clock_is_not_where_a_recording_begins(
    monkeypatch, ahead_sec, count
):
    """`sleep_until` returns at once then, and a thread sleeps on until a time that is ahead."""
    now = SimpleNamespace(sec=100.0)
    times_sec = [100.1, *(100.0 + 30.0 + 0.2 * n for n in range(100))]
    watcher = SimpleNamespace(late_sec=0.0)
    recorder = object.__new__(Recorder)
    recorder.received, recorder.topic_name = [], TOPIC
    recorder.publishers = lambda: ('/a',)

    def take_all():
        while times_sec and times_sec[0] <= now.sec:
            recorder.received.append((None, round(times_sec.pop(0) * 1e9)))

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
    recording = wall_recording.wall(watcher, recorder, why=Inconclusive(sampling.UNEVEN))
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
def test_only_who_published_on_the_robots_clock_may_remember_its_time(
    monkeypatch, why, is_waited_for
):
    monkeypatch.setattr(wall_recording, 'ahead_sec', lambda: 30.0)
    assert wall_recording.remembers_sec(why) == (30.0 if is_waited_for else 0.0)


IGNORES = (
    "note: /kinematics_publisher ignores the robot's clock (use_sim_time); "
    'judged on the wall clock\n'
)


@pytest.mark.parametrize(
    ('node', 'out'),
    [
        ('steady_clock', IGNORES),
        ('sleep_loop', IGNORES),
        ('unresponsive', ''),
        ('no_parameter_services', ''),
        ('multithreaded', ''),
        ('create_rate', ''),
        ('busy_callback', ''),
    ],
)
def test_honest_nodes_that_are_no_plain_timers_pass(capfd, node, out):
    with running(node):
        recording = topic(TOPIC).record()
        recording.assert_rate(hz=5.0)
    assert capfd.readouterr() == (out, '')


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node', 'seen'),
    [
        ('bursts_without_services', r'pauses of (0\.9|1\.)'),
        ('a_little_fast_without_services', r'5\.1\d Hz over'),
        ('a_little_slow_without_services', r'4\.8\d Hz over'),
        ('a_little_fast_loop', r'5\.1\d Hz over'),
        ('nearly_by_turns', r'0\.\d+ to 0\.\d+ s between messages over .* unevenly spaced'),
        ('nearly_by_turns_on_its_clock', r'0\.\d+ s between messages over .* unevenly spaced'),
        ('by_turns', r'0\.\d+ to 0\.\d+ s between messages over \d+ s .* unevenly spaced'),
        ('too_busy', r'[34]\.\d+ Hz over 4 s'),
    ],
)
def test_a_near_miss_fails_on_the_wall_clock(node, seen):
    with running(node), pytest.raises(CheckFailed, match=seen):
        topic(TOPIC).record().assert_rate(hz=5.0)


def looked_at(node, *, timeout_sec):
    with running(node), Watcher() as watcher:
        recorder = topic(TOPIC).listen(watcher)
        return wall_recording.wall(watcher, recorder, seconds=0.1, timeout_sec=timeout_sec)


def test_the_wall_clock_waits_for_the_next_message_of_a_slow_node():
    recording = looked_at('one_hz', timeout_sec=10.0)
    (sample,) = recording.messages
    assert sample.time_sec == recording.seconds > 0.1


@pytest.mark.slow
@pytest.mark.parametrize(('timeout_sec', 'seconds'), [(0.4, 0.4), (0.0, 0.1)])
def test_the_wall_clock_tells_how_long_there_was_nothing(timeout_sec, seconds):
    recording = looked_at('never_spins', timeout_sec=timeout_sec)
    assert (recording.messages, recording.seconds) == ((), seconds)


def on_wall(gaps_sec, *, late_sec):
    """A recording on the wall clock of messages so far apart."""
    times = [sum(gaps_sec[:n]) for n in range(1, len(gaps_sec) + 1)]
    samples = tuple(Sample(None, at, at) for at in times)
    return Recording(
        topic_name=TOPIC,
        messages=samples,
        clock='wall',
        publishers=('/a',),
        seconds=times[-1],
        start_sec=0.0,
        late_sec=late_sec,
    )


LOOKS_EVERY_10_MS = [0.21, 0.21, 0.2, 0.21, 0.21, 0.22, 0.21] * 3
SLOWER = [0.23, 0.231] * 7


@pytest.mark.parametrize(('gaps_sec', 'goes_on'), [([0.2] * 15, True), (SLOWER, False)])
def test_who_goes_on_at_another_rate_is_looked_at_anew(monkeypatch, gaps_sec, goes_on):
    again, earlier = on_wall(gaps_sec, late_sec=0.0), on_wall([0.2] * 20, late_sec=0.0)
    monkeypatch.setattr(wall_recording, 'wall', lambda *_, **__: again)
    assert wall_recording.goes_on(None, None, earlier) is goes_on


KEPT_WAITING = [0.2, 0.21, 0.9, 0.2, 0.33, 0.2, 0.2, 0.8, 1.1, 0.2, 0.27, 0.5]


@pytest.mark.parametrize(
    ('gaps_sec', 'is_makeshift', 'doubt'),
    [
        (LOOKS_EVERY_10_MS, True, Starved),
        (LOOKS_EVERY_10_MS, False, CheckFailed),
        (KEPT_WAITING, True, Starved),
        (KEPT_WAITING, False, CheckFailed),
        ([1.0, 1.01, 1.0, 1.01], True, CheckFailed),
        ([0.1, 0.11] * 15, True, CheckFailed),
    ],
    ids=['nearly right', 'the clock was driven', 'pauses', 'pauses of its own', '1 Hz', '10 Hz'],
)
def test_what_is_exact_on_the_robots_clock_alone_is_no_zero_where_that_had_no_time(
    monkeypatch, gaps_sec, is_makeshift, doubt
):
    monkeypatch.setattr(recording_module.callbacks, 'expect_none_so_far', lambda names: None)
    recording = replace(on_wall(gaps_sec, late_sec=0.0), is_makeshift=is_makeshift)
    with pytest.raises(CheckFailed) as failed:
        recording.assert_rate(hz=5.0)
    assert failed.type is doubt


@pytest.mark.parametrize(
    ('node', 'is_busy', 'is_makeshift'),
    [
        ('unresponsive', True, True),
        ('unresponsive', False, False),
        ('no_parameter_services', True, False),  # no machine is to blame for that
    ],
)
def test_a_busy_machine_is_to_blame_where_the_clock_could_not_be_driven(
    monkeypatch, node, is_busy, is_makeshift
):
    monkeypatch.setattr(Stopwatch, 'is_busy', lambda watch: is_busy)
    with running(node):
        recording = topic(TOPIC).record()
    assert (recording.clock, recording.is_makeshift) == ('wall', is_makeshift)


STARVED_GAPS = [0.2, 0.33, 0.21, 0.41, 0.2, 0.28, 0.2, 0.37, 0.22, 0.2, 0.3, 0.25, 0.44, 0.2]
"""Of a right node on a machine that had no time for it: 3.7 Hz."""


@pytest.mark.parametrize(
    ('gaps_sec', 'late_sec', 'doubt'),
    [
        (STARVED_GAPS, 0.15, Starved),
        (STARVED_GAPS, 0.0, CheckFailed),
        ([0.25] * 16, 0.3, CheckFailed),
        ([1.0, 1.02, 0.99, 1.01], 0.3, CheckFailed),
        ([0.1, 0.12, 0.08, 0.13, 0.1, 0.07] * 5, 0.3, CheckFailed),
        ([0.1, 0.3, 0.11, 0.29] * 10, 0.3, CheckFailed),
        ([0.2, 0.21, 0.2, 0.19, 1.4, 0.2, 0.2, 0.23, 0.2, 0.2], 0.1, CheckFailed),
    ],
    ids=['starved', 'idle', '4_hz', '1_hz', '10_hz', 'by_turns', 'a_pause'],
)
def test_a_machine_is_blamed_only_for_what_it_can_do(monkeypatch, gaps_sec, late_sec, doubt):
    monkeypatch.setattr(recording_module.callbacks, 'expect_none_so_far', lambda names: None)
    with pytest.raises(CheckFailed) as failed:
        on_wall(gaps_sec, late_sec=late_sec).assert_rate(hz=5.0)
    assert failed.type is doubt


@pytest.mark.parametrize(
    ('gaps_sec', 'was_busy', 'doubt'),
    [
        (STARVED_GAPS[:6], True, CheckFailed),
        ([*STARVED_GAPS, *[0.2] * 12], True, Starved),
        ([*STARVED_GAPS, *[0.2] * 12], False, CheckFailed),
        ([0.22] * 16, True, CheckFailed),
        ([0.206, 0.2065] * 10, True, Starved),
        ([0.206, 0.2065] * 10, False, CheckFailed),
        ([0.194, 0.1945] * 10, True, CheckFailed),
        ([*[0.2] * 9, 0.4, *[0.2] * 9], True, Starved),
        ([*[0.2] * 9, 0.4, *[0.2] * 9], False, CheckFailed),
        ([*[0.21] * 9, 0.42, *[0.21] * 9], True, CheckFailed),
    ],
    ids=[
        *('0.7 of the rate', 'nearly right', 'idle', '4.5 Hz'),
        *('late each time', 'late each time, idle', 'early each time'),
        *('one pause', 'one pause, idle', 'one pause of another rate'),
    ],
)
def test_a_busy_machine_is_to_blame_also_where_the_recording_itself_was_in_time(
    monkeypatch, gaps_sec, was_busy, doubt
):
    monkeypatch.setattr(recording_module.callbacks, 'expect_none_so_far', lambda names: None)
    recording = replace(on_wall(gaps_sec, late_sec=0.0), was_busy=was_busy)
    with pytest.raises(CheckFailed) as failed:
        recording.assert_rate(hz=5.0)
    assert failed.type is doubt
