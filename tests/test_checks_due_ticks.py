"""When the next message of a timer is due, computed from earlier ticks."""

import pytest
from my_robot_basics.checks.clock.due_ticks import DueTicks

STEP_NS = 10**8


def learned(gaps, *, messages=1, took_sec=0.001, step_ns=STEP_NS):
    """Simulate ticks of which every nth brings messages; return how many were due."""
    due, was_due = DueTicks(), []
    for gap in gaps:
        for tick in range(1, gap + 1):
            is_last = tick == gap
            was_due.append(due.is_next(step_ns))
            due.note(step_ns, messages=messages * is_last, took_sec=took_sec)
    return due, was_due


def test_a_message_is_due_once_three_have_come_equally_far_apart():
    _, was_due = learned([2, 2, 2, 2, 2])
    assert was_due == [*[False] * 7, True, False, True]


@pytest.mark.parametrize(
    ('gaps', 'options'),
    [
        ([2, 2], {}),
        ([2, 3, 2, 3, 2, 3], {}),
        # with no empty tick between them, other messages would not be noticed
        ([1, 1, 1, 1, 1, 1], {}),
        ([2, 2, 2, 2], {'messages': 2}),
        # the callback may still run when the next tick comes
        ([2, 2, 2, 2], {'took_sec': 0.1}),
    ],
)
def test_no_message_is_due_without_a_clear_pattern_of_ticks(gaps, options):
    due, was_due = learned(gaps, **options)
    assert not any(was_due)
    due.note(STEP_NS, messages=0, took_sec=0.001)
    assert not due.is_next(STEP_NS)


def test_a_pattern_of_ticks_is_forgotten_after_a_missing_message_or_other_steps():
    due, _ = learned([2, 2, 2, 1])
    assert not due.is_next(STEP_NS)
    due, _ = learned([2, 2, 2])
    due.note(STEP_NS, messages=0, took_sec=0.001)
    assert due.is_next(STEP_NS)
    assert not due.is_next(2 * STEP_NS)
    due.note(STEP_NS, messages=0, took_sec=0.001)
    assert not due.is_next(STEP_NS)
    due.note(2 * STEP_NS, messages=1, took_sec=0.001)
    due.note(2 * STEP_NS, messages=0, took_sec=0.001)
    assert not due.is_next(2 * STEP_NS)


def test_a_message_may_be_next_from_the_shortest_distance_of_the_last_three_on():
    due, _ = learned([5, 6, 5])
    may_be = []
    for _ in range(6):
        may_be.append(due.may_be_next(STEP_NS))
        due.note(STEP_NS, messages=0, took_sec=0.001)
    assert may_be == [*[False] * 4, True, True]


@pytest.mark.parametrize('gaps', [[], [5, 5]])
def test_a_message_may_always_be_next_before_three_have_come(gaps):
    due, _ = learned(gaps)
    assert due.may_be_next(STEP_NS)


def test_a_message_may_always_be_next_after_a_change_of_the_steps():
    due, _ = learned([5, 5, 5])
    assert not due.may_be_next(STEP_NS)
    assert due.may_be_next(2 * STEP_NS)


def test_a_message_may_be_expected_in_each_tick_of_a_long_step():
    due, _ = learned([2, 2, 2])
    due.expect_each(2 * STEP_NS)
    for _ in range(3):
        assert due.is_next(2 * STEP_NS)
        due.note(2 * STEP_NS, messages=1, took_sec=0.001)
    due.note(2 * STEP_NS, messages=0, took_sec=0.001)
    assert not due.is_next(2 * STEP_NS)


def test_no_message_is_expected_in_each_tick_after_another_step():
    due, _ = learned([2, 2, 2])
    due.expect_each(2 * STEP_NS)
    for _ in range(5):
        due.note(STEP_NS, messages=1, took_sec=0.001)
        assert not due.is_next(STEP_NS)
        assert not due.is_next(2 * STEP_NS)
