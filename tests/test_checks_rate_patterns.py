"""Which messages come from one timer, and which have alternating gaps, bursts or omissions."""

import itertools
import math
import random

import pytest
from made_recordings import every, recording, ticked
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.recordings import rates


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
def test_messages_are_even_if_one_timer_explains_their_times(times, even):
    assert rates.is_even(recording(times)) is even


def test_messages_alternately_early_and_late_are_uneven():
    turns = [0.2 * i - 0.1 * (i % 2) for i in range(1, 50)]
    assert rates.is_even(recording(turns))
    assert not rates.is_nearly_even(recording(turns, step_sec=0.02))
    with pytest.raises(CheckFailed, match=r'saw 0\.10 to 0\.30 s between messages .* one timer'):
        recording(turns, clock='wall').assert_rate(hz=5.0)


TURNS = [(0.15, 0.25), (0.18, 0.22), (0.15, 0.2, 0.25), (0.22, 0.22, 0.16), (0.2, 0.2, 0.15, 0.25)]


@pytest.mark.parametrize('turns', TURNS)
@pytest.mark.parametrize('late_sec', [0.0, 0.01])
def test_alternating_gaps_fail_as_unevenly_spaced(turns, late_sec):
    seed = random.Random(0)
    for seconds in 4.0, 8.0:
        gaps = itertools.islice(itertools.cycle(turns), round(5 * seconds))
        times = [time + late_sec * seed.random() ** 2 for time in itertools.accumulate(gaps)]
        with pytest.raises(CheckFailed, match='so use one timer, and do not change its period'):
            recording(times, clock='wall', seconds=seconds).assert_rate(hz=5.0)


def test_alternating_gaps_are_seen_with_finer_clock_steps():
    by_turns = list(itertools.accumulate([0.15, 0.25] * 8))
    for step_sec in 0.02, 0.05:
        times = [step_sec * math.ceil(time / step_sec - 1e-9) for time in by_turns]
        assert not rates.is_nearly_even(recording(times, step_sec=step_sec))
    for period_sec in 0.2, 0.21, 0.205, 0.195, 0.213:
        assert rates.is_nearly_even(recording(ticked(period_sec, 3.0, 0.02), step_sec=0.02))


@pytest.mark.parametrize('nth', [7, 10, 20, 50, 100])
def test_a_message_left_out_regularly_fails_without_a_second_look(nth):
    times = [time for i, time in enumerate(every(0.2, 310), start=1) if (i + 3) % nth]
    made = recording(times, seconds=62.0, look_again=lambda _: pytest.fail('looked'))
    with pytest.raises(CheckFailed, match=f'saw one message of {nth} missing each time .*: publ'):
        made.assert_rate(hz=5.0)


@pytest.mark.parametrize('missing', [(), (9,), (9, 19), (9, 19, 30), (9, 19, 29, 41)])
def test_messages_missed_irregularly_do_not_count_as_left_out(missing):
    times = [time for i, time in enumerate(every(0.2, 300)) if i not in missing]
    assert not rates.leaves_out(recording(times, seconds=60.0))


def in_bursts(apart_sec, size, *, step_sec, seconds=6.0, **changes):
    times = [time for time in every(apart_sec, round(seconds / apart_sec)) for _ in range(size)]
    return recording(times, step_sec=step_sec, seconds=seconds, **changes)


def test_regular_bursts_fail_without_a_second_look():
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
def test_a_pattern_that_finer_steps_do_not_confirm_is_ignored(proof):
    assert rates.pattern_of(in_bursts(1.0, 5, step_sec=0.1)) is None
    assert rates.pattern_of(in_bursts(1.0, 5, step_sec=0.1, proof=proof)) is None


def at(gaps, *, step_sec, seconds=6.0, **changes):
    """Messages of a node that publishes at these gaps by turns: each in the next tick."""
    times = itertools.takewhile(
        lambda time: time < seconds + 1e-6, itertools.accumulate(itertools.cycle(gaps))
    )
    ticked = [math.ceil(time / step_sec - 1e-6) * step_sec for time in times]
    return recording(ticked, step_sec=step_sec, seconds=seconds, **changes)


def test_messages_that_finer_steps_separate_are_no_burst():
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
        ([*[0.21] * 6, 0.14], False),  # a loop that looks each 0.07 s whether 0.2 s are over
        ([0.2], False),
    ],
)
def test_a_pattern_counts_only_if_no_single_timer_makes_it(gaps, is_one):
    made = at(gaps, step_sec=0.1, proof=at(gaps, step_sec=0.04))
    assert (rates.pattern_of(made) is not None) is is_one


def test_alternating_gaps_on_the_simulated_clock_fail_without_a_second_look():
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
def test_a_pattern_is_found_if_it_repeats_in_the_same_ticks(times, pattern):
    made = recording([float(time) for time in times], seconds=4.0)
    found = rates.pattern_in(made)
    assert found == (pattern and pytest.approx(pattern))


def test_pairs_and_wrong_rates_are_not_called_unevenly_spaced():
    twice = [0.2 * (i // 2) + 0.001 * (i % 2) for i in range(2, 82)]
    with pytest.raises(CheckFailed, match='publish one message each time the timer fires'):
        recording(twice, clock='wall').assert_rate(hz=5.0)
    with pytest.raises(CheckFailed, match=r'saw 50\.0 Hz .*: the timer period is in seconds'):
        recording(every(0.02), clock='wall').assert_rate(hz=5.0)


def test_bursts_fail_on_the_wall_clock_and_one_hiccup_passes():
    bursts = [i // 5 + 1.0 + 0.001 * (i % 5) for i in range(-5, 46)][6:]
    with pytest.raises(CheckFailed, match=r'saw pauses of 1\.0 s over 10 s \(45 messages\)'):
        recording(bursts, clock='wall').assert_rate(hz=5.0)
    hiccup = [*every(0.2, 10), 2.3, *(t + 2.0 for t in every(0.2)[1:])]
    recording(hiccup, clock='wall').assert_rate(hz=5.0)
