"""What a recording may say: assertions on made-up arrivals, each with a near miss."""

import contextlib
import itertools
import math
import random
import resource

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from my_robot_basics.checks import CheckFailed, periods, rates
from my_robot_basics.checks.recording import Recording, Sample
from my_robot_basics.exchange import node_troubles
from sensor_msgs.msg import JointState

START_SEC = 1000.0
LOW, HIGH = (-math.pi / 2, -2.1), (math.pi / 2, 2.1)


def joint_state(time_sec, **changes):
    message = JointState(name=['joint1', 'joint2'], position=[0.5, -1.0])
    message.header.frame_id = 'base_link'
    stamp = changes.pop('stamp', START_SEC + time_sec)
    message.header.stamp = Time(sec=int(stamp), nanosec=round(stamp % 1 * 1e9))
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def recording(times=None, *, clock='simulated', message=joint_state, **changes):
    times = [0.2 * i for i in range(1, 51)] if times is None else times
    samples = (Sample(message(time), time, START_SEC + time) for time in times)
    seconds = times[-1] if clock == 'wall' and times else 10.0
    fields = {'publishers': ('/a',), 'seconds': seconds, 'start_sec': START_SEC, 'step_sec': 0.1}
    fields |= changes
    return Recording(topic_name='/t', messages=tuple(samples), clock=clock, **fields)


@contextlib.contextmanager
def resource_limit(addresses):
    former = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (addresses, former[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, former)


def every(period_sec, count=50):
    return [period_sec * i for i in range(1, count + 1)]


FAST = every(0.1, 40)
LATE_FIRST = [*every(0.01, 21), *(0.2 * number for number in range(2, 21))]


@pytest.mark.parametrize(
    ('times', 'was_busy', 'looks'),
    [
        (FAST, False, 0),
        (FAST, True, 1),  # whatever made it so, it is looked at once more
        (every(0.14, 28), False, 1),  # 7.1 Hz: near enough to be looked at once more
        (LATE_FIRST, False, 1),  # what was late came at once
        (FAST[:30], False, 1),
    ],
)
def test_far_too_many_messages_need_no_second_look(times, was_busy, looks):
    looked = []

    def look_again(seconds):
        looked.append(seconds)
        return recording(FAST, clock='wall')

    made = recording(times, clock='wall', seconds=4.0, was_busy=was_busy, look_again=look_again)
    with pytest.raises(CheckFailed, match=r'expected 5\.0 Hz, saw'):
        made.assert_rate(hz=5.0)
    assert len(looked) == looks


def test_a_period_of_0_is_named():
    made = recording(every(0.003, 1400), clock='wall', seconds=4.0)
    with pytest.raises(CheckFailed, match=r'333.*Hz .*: the timer period is 0, or nearly'):
        made.assert_rate(hz=5.0)


def test_far_too_many_messages_are_named_though_they_have_ended():
    made = recording(every(0.002, 1500), clock='wall', seconds=4.0)
    assert made.is_over
    with pytest.raises(CheckFailed, match=r'saw 500.0 Hz .* another timer: make one, in __init__'):
        made.assert_rate(hz=5.0)


def test_pauses_are_named_below_nine_tenths_of_the_rate_too():
    times = [0.2 * number for number in range(1, 21) if number % 6]
    made = recording(times, clock='wall', seconds=4.0)
    assert made.rate_hz < 4.5
    with pytest.raises(CheckFailed, match=r'saw pauses of 0\.4 s over'):
        made.assert_rate(hz=5.0)


@pytest.mark.parametrize('period_sec', [0.2, 0.4])
def test_a_callback_that_raised_fails_at_any_rate(monkeypatch, period_sec):
    made = recording(every(period_sec))
    monkeypatch.setattr(
        node_troubles, 'last_raised', lambda name: {'/a': 'ValueError: no pose'}[name]
    )
    with pytest.raises(
        CheckFailed, match='callback raised ValueError: no pose, so fix that first'
    ):
        made.assert_rate(hz=5.0)


@pytest.mark.parametrize(
    ('clock', 'period_sec', 'passes'),
    [
        ('simulated', 0.2, True),
        ('simulated', 1 / 4.91, True),
        ('simulated', 1 / 4.89, False),
        ('simulated', 1 / 5.09, True),
        ('simulated', 1 / 5.11, False),
        ('wall', 1 / 4.91, True),
        ('wall', 1 / 4.89, False),
        ('wall', 1 / 5.09, True),
        ('wall', 1 / 5.11, False),
        ('wall', 1.0, False),
        ('wall', 0.04, False),
    ],
)
def test_a_rate_has_a_tolerance(clock, period_sec, passes):
    made = recording(every(period_sec), clock=clock)
    if passes:
        made.assert_rate(hz=5.0)
    else:
        with pytest.raises(CheckFailed, match=r'expected 5\.0 Hz, saw'):
            made.assert_rate(hz=5.0)


@pytest.mark.parametrize(
    ('times', 'even'),
    [
        (every(0.2), True),
        (every(0.2, 2), True),
        ([0.1 * math.ceil(i / 5.25 * 10) for i in range(1, 50)], True),
        ([5.0, 10.0], True),
        ([0.2], False),
        ([], False),
        # five at once, pairs, and a thread that misses a tick now and then
        ([i // 5 + 1.0 for i in range(50)], False),
        ([0.4 * (i // 2 + 1) for i in range(50)], False),
        ([0.2 * i + 0.1 * (i % 7 > 4) for i in range(1, 50)], True),
        ([0.2 * i + 0.1 * (i // 7 + i // 10) for i in range(1, 50)], False),
        ([0.2 * i + (0.2 if i > 25 else 0.0) for i in range(1, 50)], False),
    ],
)
def test_even_is_what_one_timer_explains(times, even):
    assert rates.is_even(recording(times)) is even


def ticked(period_sec, seconds, step_sec, *, late=()):
    """When messages of a timer are seen on a clock that moves in steps; some a step late."""
    count = int(seconds / period_sec)
    ticks = [math.ceil(period_sec * i / step_sec - 1e-9) + (i in late) for i in range(1, count)]
    return [step_sec * tick for tick in ticks]


def proven(period_sec, proof_period_sec=None, *, late=(), proof_late=()):
    proof = ticked(proof_period_sec or period_sec, 3.0, 0.02, late=proof_late)
    return recording(
        ticked(period_sec, 10.0, 0.1, late=late),
        proof=recording(proof, step_sec=0.02, seconds=3.0),
        look_again=lambda seconds: recording(every(0.2), clock='wall'),
    )


def begun_late(period_sec=0.2, again_sec=0.2):
    """Messages of a thread that was a step late for the one at which the recording begins."""
    return recording(
        [time - 0.1 for time in ticked(period_sec, 4.0, 0.1)],
        seconds=4.0,
        proof=recording(ticked(period_sec, 3.0, 0.02), step_sec=0.02, seconds=3.0),
        look_again=lambda seconds: recording(every(again_sec), clock='wall'),
    )


@pytest.mark.parametrize('period_sec', [0.195, 0.205, 0.19, 0.21, 0.25, 1.0])
def test_a_timer_that_two_steps_of_the_clock_agree_on_is_certain(period_sec):
    with pytest.raises(CheckFailed, match=rf'saw {round(1 / period_sec, 2)} Hz over 10 s'):
        proven(period_sec).assert_rate(hz=5.0)


@pytest.mark.parametrize(
    'made',
    [
        proven(0.2),
        proven(0.2, late=(7,), proof_late=(3, 4)),
        # a thread that comes late now and then is later with coarse steps: another look decides
        proven(0.206, 0.201),
        proven(0.21, 0.202),
        begun_late(),
    ],
)
def test_a_period_that_the_steps_have_made_is_not(made):
    made.assert_rate(hz=5.0)


def test_another_look_decides_where_the_mean_alone_is_off():
    with pytest.raises(CheckFailed, match=r'saw 4\.88 Hz over 10'):
        begun_late(again_sec=0.205).assert_rate(hz=5.0)


def test_by_turns_too_early_and_too_late_is_uneven():
    turns = [0.2 * i - 0.1 * (i % 2) for i in range(1, 50)]
    assert rates.is_even(recording(turns))
    assert not rates.is_nearly_even(recording(turns, step_sec=0.02))
    with pytest.raises(CheckFailed, match=r'saw 0\.10 to 0\.30 s between messages .* one timer'):
        recording(turns, clock='wall').assert_rate(hz=5.0)


TURNS = [(0.15, 0.25), (0.18, 0.22), (0.15, 0.2, 0.25), (0.22, 0.22, 0.16), (0.2, 0.2, 0.15, 0.25)]


@pytest.mark.parametrize('turns', TURNS)
@pytest.mark.parametrize('late_sec', [0.0, 0.01])
def test_what_comes_by_turns_is_no_rate(turns, late_sec):
    seed = random.Random(0)
    for seconds in 4.0, 8.0:
        gaps = itertools.islice(itertools.cycle(turns), round(5 * seconds))
        times = [time + late_sec * seed.random() ** 2 for time in itertools.accumulate(gaps)]
        with pytest.raises(CheckFailed, match='so use one timer, and do not change its period'):
            recording(times, clock='wall', seconds=seconds).assert_rate(hz=5.0)


def test_turns_are_seen_with_steps_of_the_clock_that_are_finer_than_they():
    by_turns = list(itertools.accumulate([0.15, 0.25] * 8))
    for step_sec in 0.02, 0.05:
        times = [step_sec * math.ceil(time / step_sec - 1e-9) for time in by_turns]
        assert not rates.is_nearly_even(recording(times, step_sec=step_sec))
    for period_sec in 0.2, 0.21, 0.205, 0.195, 0.213:
        assert rates.is_nearly_even(recording(ticked(period_sec, 3.0, 0.02), step_sec=0.02))


def on_a_busy_machine(period_sec, *, seconds, is_loop=False, seed=0):
    """When messages of a timer, or of a loop that sleeps, are seen: one of four is late."""
    chance = random.Random(seed)
    late = [
        3e-4 + (chance.random() < 0.25) * min(0.1, chance.expovariate(1 / 0.015))
        for _ in range(int(seconds / period_sec))
    ]
    if is_loop:
        return list(itertools.accumulate(period_sec + each for each in late))
    return [period_sec * i + each for i, each in enumerate(late, start=1)]


@pytest.mark.parametrize('is_loop', [False, True])
@pytest.mark.parametrize('seconds', [4.0, 8.0])
def test_a_busy_machine_hides_no_period_and_makes_none(is_loop, seconds):
    for seed in range(30):
        for period_sec, passes in (0.2, True), (0.195, False), (0.205, False):
            times = on_a_busy_machine(period_sec, seconds=seconds, is_loop=is_loop, seed=seed)
            made = recording(times, clock='wall', seconds=seconds)
            assert abs(periods.meant(rates.times_of(made)) / period_sec - 1.0) < 0.01
            assert rates.has_rate(made, 5.0) is passes


def test_a_doubt_on_the_wall_clock_asks_for_a_longer_look():
    asked = []

    def look_again(period_sec):
        def look(seconds):
            asked.append(seconds)
            return recording(every(period_sec), clock='wall')

        return look

    def look(period_sec, again_sec):
        made = recording(every(period_sec, 20), clock='wall', look_again=look_again(again_sec))
        made.assert_rate(hz=5.0)

    look(0.201, 0.3)  # no doubt
    look(0.203, 0.201)
    look(0.205, 0.201)
    assert asked == [8.0, 8.0]
    for first_sec in 0.203, 0.205:
        with pytest.raises(CheckFailed, match=r'saw 4\.88 Hz over 10\.2 s'):
            look(first_sec, 0.205)


def test_a_longer_look_with_pauses_takes_nothing_back():
    def look(seconds):
        return recording(
            [*every(0.2, 20), *(0.4 + time for time in every(0.2, 40)[20:])], clock='wall'
        )

    recording(every(0.203, 20), clock='wall', look_again=look).assert_rate(hz=5.0)
    with pytest.raises(CheckFailed, match='pauses of'):
        recording(every(0.205, 20), clock='wall', look_again=look).assert_rate(hz=5.0)


@pytest.mark.parametrize('nth', [7, 10, 20, 50, 100])
def test_a_message_that_is_left_out_again_and_again_leaves_no_doubt(nth):
    times = [time for i, time in enumerate(every(0.2, 310), start=1) if (i + 3) % nth]
    made = recording(times, seconds=62.0, look_again=lambda _: pytest.fail('looked'))
    with pytest.raises(CheckFailed, match=f'saw one message of {nth} missing each time .*: publ'):
        made.assert_rate(hz=5.0)


@pytest.mark.parametrize('missing', [(), (9,), (9, 19), (9, 19, 30), (9, 19, 29, 41)])
def test_what_a_thread_misses_now_and_then_is_not_left_out(missing):
    times = [time for i, time in enumerate(every(0.2, 300)) if i not in missing]
    assert not rates.leaves_out(recording(times, seconds=60.0))


def in_bursts(apart_sec, size, *, step_sec, seconds=6.0, **changes):
    times = [time for time in every(apart_sec, round(seconds / apart_sec)) for _ in range(size)]
    return recording(times, step_sec=step_sec, seconds=seconds, **changes)


def test_messages_that_come_at_once_each_time_leave_no_doubt():
    finer = in_bursts(1.0, 5, step_sec=0.04)
    made = in_bursts(1.0, 5, step_sec=0.1, proof=finer, look_again=lambda _: pytest.fail('looked'))
    with pytest.raises(CheckFailed, match=r'saw 5 messages at once, every 1 s, over 6 s \(30'):
        made.assert_rate(hz=5.0)


@pytest.mark.parametrize(
    'proof',
    [
        None,
        in_bursts(0.8, 4, step_sec=0.04),  # a thread that is late by so many steps
        in_bursts(0.6, 5, step_sec=0.04),
        recording(every(0.2, 30), step_sec=0.04, seconds=6.0),
    ],
)
def test_a_pattern_that_finer_steps_do_not_show_is_none(proof):
    assert rates.pattern_of(in_bursts(1.0, 5, step_sec=0.1)) is None
    assert rates.pattern_of(in_bursts(1.0, 5, step_sec=0.1, proof=proof)) is None


def at(gaps, *, step_sec, seconds=6.0, **changes):
    """Messages of a node that publishes at these gaps by turns: each in the next tick."""
    times = itertools.takewhile(
        lambda time: time < seconds + 1e-6, itertools.accumulate(itertools.cycle(gaps))
    )
    ticked = [math.ceil(time / step_sec - 1e-6) * step_sec for time in times]
    return recording(ticked, step_sec=step_sec, seconds=seconds, **changes)


def test_two_timers_that_finer_steps_tell_apart_are_no_burst():
    finer = at([0.04, 0.16], step_sec=0.04)
    assert rates.pattern_of(in_bursts(0.2, 2, step_sec=0.1, proof=finer)) is None


@pytest.mark.parametrize(
    ('gaps', 'is_one'),
    [
        ([0.1, 0.3], True),
        ([0.04, 0.36], True),
        ([0.1, 0.1, 0.4], True),
        ([0.0, 0.1, 0.1], True),  # two timers, of 0.2 s and of 0.1 s
        ([0.18, 0.22], False),  # the wall clock looks more closely
        ([*[0.21] * 6, 0.14], False),  # who looks each 0.07 s whether 0.2 s are over
        ([0.2], False),
    ],
)
def test_a_pattern_is_one_that_no_timer_makes_by_whatever_steps(gaps, is_one):
    made = at(gaps, step_sec=0.1, proof=at(gaps, step_sec=0.04))
    assert (rates.pattern_of(made) is not None) is is_one


def test_messages_by_turns_leave_no_doubt_where_the_robots_clock_shows_them():
    finer = at([0.1, 0.3], step_sec=0.04)
    made = at([0.1, 0.3], step_sec=0.1, proof=finer, look_again=lambda _: pytest.fail('looked'))
    with pytest.raises(CheckFailed, match=r'saw 0\.10 to 0\.30 s between messages over 6 s'):
        made.assert_rate(hz=5.0)


@pytest.mark.parametrize(
    ('times', 'pattern'),
    [
        ([1, 1, 2, 2, 3, 3, 4, 4], (2, 1.0, True)),
        ([0.5, 1, 1, 1.5, 2, 2, 2.5, 3, 3, 3.5, 4, 4], (3, 1.0, False)),
        ([2, 2, 4, 4], None),  # few
        ([1, 1, 2, 2, 3, 4, 4], None),  # one alone
        ([1, 1, 2, 2, 3.5, 3.5], None),  # late
        ([0.5, 0.5, 1, 1, 1.5, 1.5, 2, 2], None),  # none in the last two seconds
        ([1, 2, 3, 4], None),
        ([], None),
    ],
)
def test_a_pattern_comes_again_in_the_same_ticks(times, pattern):
    made = recording([float(time) for time in times], seconds=4.0)
    found = rates.pattern_in(made)
    assert found == (pattern and pytest.approx(pattern))


def test_pairs_and_plain_rates_are_not_taken_for_turns():
    twice = [0.2 * (i // 2) + 0.001 * (i % 2) for i in range(2, 82)]
    with pytest.raises(CheckFailed, match='publish one message each time the timer fires'):
        recording(twice, clock='wall').assert_rate(hz=5.0)
    with pytest.raises(CheckFailed, match=r'saw 50\.0 Hz .*: the timer period is in seconds'):
        recording(every(0.02), clock='wall').assert_rate(hz=5.0)


def test_on_the_wall_clock_the_largest_gap_counts():
    bursts = [i // 5 + 1.0 + 0.001 * (i % 5) for i in range(-5, 46)][6:]
    with pytest.raises(CheckFailed, match=r'saw pauses of 1\.0 s over 10 s \(45 messages\)'):
        recording(bursts, clock='wall').assert_rate(hz=5.0)
    hiccup = [*every(0.2, 10), 2.3, *(t + 2.0 for t in every(0.2)[1:])]
    recording(hiccup, clock='wall').assert_rate(hz=5.0)


@pytest.mark.parametrize(
    ('clock', 'times', 'looks'),
    [
        ('wall', every(0.2), []),
        ('wall', every(1.0), [4.0]),
        ('simulated', every(0.2), []),
        # one of every seven is late: a slow timer, or a thread that could not keep up
        ('simulated', [0.2 * i + 0.1 * (i // 7) for i in range(1, 50)], [4.0]),
    ],
)
def test_a_second_look_decides_where_the_first_leaves_a_doubt(clock, times, looks):
    asked = []

    def look_again(seconds):
        asked.append(seconds)
        return recording(every(0.2), clock='wall')

    recording(times, clock=clock, look_again=look_again).assert_rate(hz=5.0)
    assert asked == looks


def test_a_plain_timer_of_another_period_leaves_no_doubt():
    with pytest.raises(CheckFailed, match=r'saw 1\.0 Hz'):
        recording(every(1.0), look_again=lambda _: pytest.fail('looked')).assert_rate(hz=5.0)


def test_a_second_publisher_is_named_before_the_rate():
    with pytest.raises(CheckFailed, match=r'expected one publisher on /t, saw 2 \(/a, /b\)'):
        recording(every(1.0), publishers=('/a', '/b')).assert_rate(hz=5.0)


def test_a_note_is_printed_when_the_rate_is_right(capsys):
    recording(every(0.2), clock='wall', note='note: careful').assert_rate(hz=5.0)
    assert capsys.readouterr().out == 'note: careful\n'


@pytest.mark.parametrize(
    ('angle', 'seen'),
    [
        (lambda time_sec: 0.4 * time_sec, 'further out with each message: turn back'),
        (lambda time_sec: -90.0 + 10 * time_sec, 'further out with each message: turn back'),
        (lambda time_sec: 90.0 * math.sin(time_sec), 'which looks like degrees'),
    ],
)
def test_an_angle_that_grows_and_grows_is_told_from_degrees(angle, seen):
    made = recording(message=lambda time_sec: joint_state(time_sec, position=[angle(time_sec), 0]))
    with pytest.raises(CheckFailed, match=seen):
        made.assert_positions_rad(low=LOW, high=HIGH)


def swapped(time_sec):
    return joint_state(time_sec, name=['joint2', 'joint1'], position=[2.0, 1.5])


def test_names_may_come_in_any_order_with_their_positions():
    made = recording(message=swapped)
    made.assert_joint_names(('joint1', 'joint2'))
    made.assert_positions_rad(low=LOW, high=HIGH, names=('joint1', 'joint2'))
    with pytest.raises(CheckFailed):
        made.assert_positions_rad(low=LOW, high=HIGH)


MESSAGES = {
    'wrong names': ({'name': ['joint_1', 'joint_2']}, 'saw joint_1, joint_2'),
    'no names': ({'name': []}, 'expected the joint names joint1, joint2, saw none'),
    'one name': ({'name': ['joint1']}, 'saw joint1'),
    'degrees': ({'position': [23.4, -67.8]}, r'saw \(23.4, -67.8\), which looks like degrees'),
    'out of range': ({'position': [0.1, 200.0]}, 'keep each joint within its range'),
    'not a number': ({'position': [math.nan, 0.0]}, r'saw \(nan, 0\)'),
    'no position': ({'position': []}, 'expected 2 positions in each message, saw 0'),
    'three positions': ({'position': [0.0] * 3}, 'saw 3'),
    'other frame': ({'frame_id': 'world'}, "expected frame_id 'base_link', saw 'world'"),
    'no stamp': ({'stamp': 0.0}, 'saw a stamp of 0'),
    'one stamp': ({'stamp': START_SEC}, 'saw a stamp that does not advance'),
}


@pytest.mark.parametrize(('changes', 'reason'), MESSAGES.values(), ids=MESSAGES)
@pytest.mark.parametrize('clock', ['simulated', 'wall'])
def test_a_wrong_message_is_explained(clock, changes, reason):
    def message(time_sec):
        rest = {k: v for k, v in changes.items() if k != 'frame_id'}
        made = joint_state(time_sec, **rest)
        made.header.frame_id = changes.get('frame_id', 'base_link')
        return made

    def check(made):
        made.assert_joint_names(('joint1', 'joint2'))
        made.assert_positions_rad(low=LOW, high=HIGH)
        made.assert_frame_id('base_link')
        made.assert_stamps()

    check(recording(clock=clock))
    with pytest.raises(CheckFailed, match=reason):
        check(recording(clock=clock, message=message))


@pytest.mark.parametrize(
    ('clock', 'off_sec', 'passes'),
    [
        ('simulated', 0.1, True),
        ('simulated', -0.1, True),
        # the stamp of the message before
        ('simulated', -0.2, False),
        ('simulated', 0.7, False),
        ('simulated', -8.0, False),
        ('wall', -0.1, True),
        ('wall', -0.2, False),
        ('wall', -1.2, False),
    ],
)
def test_a_stamp_is_near_the_clock(clock, off_sec, passes):
    made = recording(
        clock=clock, message=lambda time: joint_state(time, stamp=START_SEC + time + off_sec)
    )
    if passes:
        made.assert_stamps()
    else:
        side = 'ahead of' if off_sec > 0.0 else 'behind'
        with pytest.raises(CheckFailed, match=rf'a stamp {abs(off_sec)} s {side} it: set'):
            made.assert_stamps()


@pytest.mark.parametrize('clock', ['simulated', 'wall'])
def test_what_is_published_twice_is_told_from_a_stamp_that_stands_still(clock):
    twice = [time for time in every(0.2) for _ in range(2)]
    with pytest.raises(CheckFailed, match='two messages at once with the same stamp: publish one'):
        recording(twice, clock=clock).assert_stamps()


@pytest.mark.parametrize(
    ('clock', 'off_sec', 'passes'),
    [
        ('simulated', -0.3, True),
        ('simulated', -0.7, False),
        ('wall', -0.7, True),
        ('wall', 1.2, False),
    ],
)
def test_one_late_message_is_not_all_of_them(clock, off_sec, passes):
    def one_late(time):
        return joint_state(time, stamp=START_SEC + time + (off_sec if time == 4.0 else 0.0))

    made = recording(every(2.0, 10), clock=clock, message=one_late)
    if passes:
        made.assert_stamps()
    else:
        side = 'ahead of' if off_sec > 0.0 else 'behind'
        with pytest.raises(CheckFailed, match=f'a stamp {abs(off_sec)} s {side} it'):
            made.assert_stamps()


def test_another_type_is_named():
    made = recording(message=lambda time: Point())
    with pytest.raises(CheckFailed, match='expected messages with a name on /t, saw Point'):
        made.assert_joint_names(('joint1', 'joint2'))


@pytest.mark.starts
@pytest.mark.parametrize('assertion', ['assert_joint_names', 'assert_frame_id', 'assert_stamps'])
def test_no_message_proves_nothing(assertion):
    arguments = {'assert_joint_names': [('joint1',)], 'assert_frame_id': ['base_link']}
    with pytest.raises(CheckFailed, match='expected messages on /t, saw none'):
        getattr(recording([]), assertion)(*arguments.get(assertion, []))


@pytest.mark.parametrize(('until_sec', 'passes'), [(3.8, True), (3.6, True), (2.0, False)])
def test_messages_that_end_on_the_wall_clock_are_no_rate(until_sec, passes):
    times = every(0.2, round(until_sec / 0.2))
    ending = recording(times, clock='wall', seconds=4.0)
    if passes:
        ending.assert_rate(hz=5.0)
        return
    with pytest.raises(
        CheckFailed, match=r'saw none in the last 2\.0 s over 4 s \(10 messages\): pub'
    ):
        ending.assert_rate(hz=5.0)


def test_a_pause_at_the_end_is_one_of_those_before():
    bursts = [start + 0.0625 * n for start in (0.0, 1.25, 2.5) for n in range(1, 7)]
    ending = recording(bursts, clock='wall', seconds=3.75)
    assert ending.has_ended
    with pytest.raises(CheckFailed, match=r'saw pauses of 0\.9 s over 3\.75 s'):
        ending.assert_rate(hz=5.0)


def test_no_message_in_another_look_says_that_they_end():
    nothing = recording([], clock='wall', seconds=4.0)
    with pytest.raises(CheckFailed, match=r'saw none in the last 4\.0 s over 4 s \(0 messages\)'):
        nothing.assert_rate(hz=5.0)


@pytest.mark.parametrize('clock', ['wall', 'simulated'])
def test_a_flood_is_told_within_some_memory(clock):
    flood = recording(every(0.0002, 50_000), clock=clock, message=lambda time: None)
    with resource_limit(3 * 2**30), pytest.raises(CheckFailed, match='the timer period is 0'):
        flood.assert_rate(hz=5.0)
