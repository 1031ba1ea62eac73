"""Whether a recording has a rate: assertions on made-up arrivals, each with a near miss."""

import contextlib
import itertools
import random
import resource

import pytest
from made_recordings import every, recording, ticked
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.recordings import periods, rates
from my_robot_basics.exchange import node_troubles


@contextlib.contextmanager
def resource_limit(addresses):
    former = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (addresses, former[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, former)


FAST = every(0.1, 40)


LATE_FIRST = [*every(0.01, 21), *(0.2 * number for number in range(2, 21))]


@pytest.mark.parametrize(
    ('times', 'was_busy', 'looks'),
    [
        (FAST, False, 0),
        (FAST, True, 1),  # on a busy machine, there is always a second look
        (every(0.14, 28), False, 1),  # 7.1 Hz: near enough to be looked at once more
        (LATE_FIRST, False, 1),  # late messages came at once
        (FAST[:30], False, 1),
    ],
)
def test_far_too_many_messages_need_no_second_look(times, was_busy, looks):
    looked = []

    def look_again(seconds):
        looked.append(seconds)
        return recording(FAST, clock='wall')

    made = recording(times, clock='wall', seconds=4.0, was_busy=was_busy, look_again=look_again)
    with pytest.raises(CheckFailed, match=r'expected 5\.0 Hz on /\w+, saw'):
        made.assert_rate(hz=5.0)
    assert len(looked) == looks


def test_a_period_of_0_and_a_loop_are_named():
    made = recording(every(0.003, 1400), clock='wall', seconds=4.0)
    with pytest.raises(
        CheckFailed, match=r'333.*Hz .*: the timer period is 0, or nearly .* publishes in a loop'
    ):
        made.assert_rate(hz=5.0)


def test_far_too_many_messages_fail_for_their_rate_even_if_they_ended():
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


@pytest.mark.parametrize(
    ('period_sec', 'why'),
    [(0.2, 'and several messages at once: publish one message'), (0.18, 'period = 1 / rate')],
)
def test_messages_at_once_are_named_only_if_the_others_have_the_rate(period_sec, why):
    times = every(period_sec, 20)
    twice = sorted([*times, times[5] + 0.001, times[15] + 0.001])
    made = recording(twice, clock='wall', seconds=20.0 * period_sec)
    with pytest.raises(CheckFailed, match=f'saw .* Hz over .*{why}'):
        made.assert_rate(hz=5.0)


def test_messages_at_once_are_not_named_if_others_are_missing():
    times = [time for number, time in enumerate(every(0.2, 30)) if number % 6 != 5]
    twice = sorted([*times, times[5] + 0.001, times[15] + 0.001])
    with pytest.raises(CheckFailed, match='saw pauses of'):
        recording(twice, clock='wall', seconds=6.0).assert_rate(hz=5.0)


@pytest.mark.parametrize('period_sec', [0.2, 0.4])
def test_a_callback_that_raised_fails_at_any_rate(monkeypatch, period_sec):
    made = recording(every(period_sec))
    monkeypatch.setattr(
        node_troubles, 'last_raised', lambda name: {'/a': 'ValueError: no pose'}[name]
    )
    with pytest.raises(CheckFailed, match='callback raised ValueError: no pose; fix that first'):
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
def test_a_rate_within_two_percent_passes(clock, period_sec, passes):
    made = recording(every(period_sec), clock=clock)
    if passes:
        made.assert_rate(hz=5.0)
    else:
        with pytest.raises(CheckFailed, match=r'expected 5\.0 Hz on /\w+, saw'):
            made.assert_rate(hz=5.0)


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
def test_a_wrong_period_fails_at_once_if_two_clock_steps_confirm_it(period_sec):
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
def test_a_right_period_passes_even_if_coarse_steps_distort_it(made):
    made.assert_rate(hz=5.0)


def test_another_look_decides_if_only_the_mean_is_off():
    with pytest.raises(CheckFailed, match=r'saw 4\.88 Hz over 10'):
        begun_late(again_sec=0.205).assert_rate(hz=5.0)


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
def test_the_period_is_found_despite_a_busy_machine(is_loop, seconds):
    for seed in range(30):
        for period_sec, passes in (0.2, True), (0.195, False), (0.205, False):
            times = on_a_busy_machine(period_sec, seconds=seconds, is_loop=is_loop, seed=seed)
            made = recording(times, clock='wall', seconds=seconds)
            assert abs(periods.intended_period(rates.times_of(made)) / period_sec - 1.0) < 0.01
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


def test_a_longer_look_with_pauses_does_not_overrule_a_passing_first_look():
    def look(seconds):
        return recording(
            [*every(0.2, 20), *(0.4 + time for time in every(0.2, 40)[20:])], clock='wall'
        )

    recording(every(0.203, 20), clock='wall', look_again=look).assert_rate(hz=5.0)
    with pytest.raises(CheckFailed, match='pauses of'):
        recording(every(0.205, 20), clock='wall', look_again=look).assert_rate(hz=5.0)


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
def test_a_second_look_decides_if_the_first_leaves_a_doubt(clock, times, looks):
    asked = []

    def look_again(seconds):
        asked.append(seconds)
        return recording(every(0.2), clock='wall')

    recording(times, clock=clock, look_again=look_again).assert_rate(hz=5.0)
    assert asked == looks


def test_a_plain_timer_of_another_period_fails_without_a_second_look():
    with pytest.raises(CheckFailed, match=r'saw 1\.0 Hz'):
        recording(every(1.0), look_again=lambda _: pytest.fail('looked')).assert_rate(hz=5.0)


def test_a_second_publisher_is_named_before_the_rate():
    with pytest.raises(CheckFailed, match=r'expected one publisher on /t, saw 2 \(/a, /b\)'):
        recording(every(1.0), publishers=('/a', '/b')).assert_rate(hz=5.0)


def test_a_note_is_printed_when_the_rate_is_right(capsys):
    recording(every(0.2), clock='wall', note='note: careful').assert_rate(hz=5.0)
    assert capsys.readouterr().out == 'note: careful\n'


@pytest.mark.parametrize('clock', ['wall', 'simulated'])
@pytest.mark.parametrize(('until_sec', 'passes'), [(3.8, True), (3.6, True), (2.0, False)])
def test_messages_that_end_early_fail(until_sec, passes, clock):
    times = every(0.2, round(until_sec / 0.2))
    ending = recording(times, clock=clock, seconds=4.0)
    if passes:
        ending.assert_rate(hz=5.0)
        return
    with pytest.raises(
        CheckFailed, match=r'saw none in the last 2\.0 s over 4 s \(10 messages\): pub'
    ):
        ending.assert_rate(hz=5.0)


@pytest.mark.parametrize('times', [[0.2], [0.2, 0.4], [0.4, 0.4]])
def test_a_few_messages_fail_even_if_their_mean_rate_is_right(times):
    with pytest.raises(CheckFailed, match=r'saw none in the last 9\.[68] s over 10 s'):
        recording(times).assert_rate(hz=5.0)


def test_a_pause_at_the_end_is_reported_like_earlier_pauses():
    bursts = [start + 0.0625 * n for start in (0.0, 1.25, 2.5) for n in range(1, 7)]
    ending = recording(bursts, clock='wall', seconds=3.75)
    assert ending.has_ended
    with pytest.raises(CheckFailed, match=r'saw pauses of 0\.9 s over 3\.75 s'):
        ending.assert_rate(hz=5.0)


def test_an_empty_second_look_reports_that_messages_ended():
    nothing = recording([], clock='wall', seconds=4.0)
    with pytest.raises(CheckFailed, match=r'saw some, and none any more over 4 s: publish'):
        nothing.assert_rate(hz=5.0)


@pytest.mark.parametrize('clock', ['wall', 'simulated'])
def test_a_flood_of_messages_is_judged_in_limited_memory(clock):
    flood = recording(every(0.0002, 50_000), clock=clock, message=lambda time: None)
    with resource_limit(3 * 2**30), pytest.raises(CheckFailed, match='the timer period is 0'):
        flood.assert_rate(hz=5.0)
