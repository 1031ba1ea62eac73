"""What a check reads from the feedback on a move, with made-up messages, each with a near miss."""

import contextlib
import math
from types import SimpleNamespace

import numpy as np
import pytest
from my_robot_basics.checks.arm.arm_lines import ON_LINE_RAD, off_line, why_off_line
from my_robot_basics.checks.arm.arm_remaining import expect_remaining
from my_robot_basics.checks.arm.arm_reports import MoveReport
from my_robot_basics.checks.arm.arm_results import ELSEWHERE, IN_DEGREES, NOT_THERE, why_off
from my_robot_basics.checks.arm.watched_arm import WatchedArm
from my_robot_basics.checks.clock.robot_time import WallTime
from my_robot_basics.feedback.errors import CheckFailed, Starved

from arm_interfaces.action import MoveArm

STEP_NS = 50_000_000
END = (0.8, -0.4)


class Wall(WallTime):
    def __init__(self, stalled_share=0.0):
        self.stalled_share = stalled_share

    def wall_sec(self):
        return 2.0

    def stalled_sec(self):
        return 2.0 * self.stalled_share


DRIVEN = SimpleNamespace(is_driven=True, step_ns=STEP_NS, at_ns=lambda wall_ns: wall_ns)


def report(parts, times, time):
    """Feedback that said at these times (s) which part of the way was done."""
    found = [
        (round(1e9 * at), MoveArm.Feedback(position=[part * each for each in END]))
        for at, part in zip(times, parts, strict=True)
    ]
    sent = SimpleNamespace(
        feedback=lambda: found,
        is_over=lambda: True,
        goal=SimpleNamespace(speed=0.8),
        statuses=lambda: [(0, None)],
        sent_ns=0,
        over_ns=lambda: found[-1][0],
    )
    arm = WatchedArm(SimpleNamespace(), time, (0.0, 0.0))
    return MoveReport(arm, sent, END)


def evenly(seconds, step_sec=STEP_NS / 1e9):
    """Times and parts of a steady move, with its last message at the goal."""
    count = round(seconds / step_sec)
    return [i * step_sec for i in range(1, count + 1)], [i / count for i in range(1, count + 1)]


@pytest.mark.parametrize('seconds', [0.5, 2.0, 60.0])
def test_a_move_with_one_message_a_step_late_is_steady(seconds):
    times, parts = evenly(seconds)
    times[3] += STEP_NS / 1e9
    report(parts, times, DRIVEN).expect_steady()


def test_a_short_move_with_one_message_two_steps_late_is_not_steady():
    times, parts = evenly(0.5)
    times[3] += 2 * STEP_NS / 1e9
    with pytest.raises(CheckFailed, match='go steadily'):
        report(parts, times, DRIVEN).expect_steady()


def test_a_long_move_of_uneven_speed_is_not_steady():
    times, parts = evenly(20.0)
    with pytest.raises(CheckFailed, match='move at one speed'):
        report([part**1.5 for part in parts], times, DRIVEN).expect_steady()


@pytest.mark.parametrize(('stalled_share', 'failure'), [(0.0, CheckFailed), (0.5, Starved)])
def test_an_unsteady_move_counts_as_starved_only_on_a_busy_machine(stalled_share, failure):
    times, parts = evenly(0.5)  # asked for: 1 s
    with pytest.raises(CheckFailed) as error:
        report([part**2 for part in parts], times, Wall(stalled_share)).expect_steady()
    assert type(error.value) is failure


def test_feedback_that_stops_before_the_end_has_a_pause():
    times, parts = evenly(2.0)
    half = len(times) // 2
    reported = report(parts[:half], times[:half], DRIVEN)
    reported.sent.over_ns = lambda: round(2e9)
    with pytest.raises(CheckFailed, match=r'a pause of 1\.0 s'):
        reported.expect_enough()


@pytest.mark.parametrize(('step_sec', 'is_right'), [(0.0, False), (0.001, False), (0.004, True)])
def test_feedback_that_comes_at_once_and_too_early_comes_from_a_loop_without_waits(
    step_sec, is_right
):
    _, parts = evenly(2.0)
    reported = report(parts, [0.01 + i * step_sec for i in range(len(parts))], DRIVEN)
    with contextlib.nullcontext() if is_right else pytest.raises(CheckFailed, match='no step'):
        reported.expect_enough()


def test_frequent_feedback_on_a_move_that_takes_its_time_is_enough():
    times, parts = evenly(2.0, step_sec=0.001)
    report(parts, times, DRIVEN).expect_enough()


@pytest.mark.parametrize(
    ('step_sec', 'stalled_share', 'is_right'),
    [(0.00105, 0.0, True), (0.0005, 0.0, False), (0.0005, 0.5, False)],
)
def test_feedback_of_a_loop_that_never_sleeps_is_refused_however_much_of_it_arrives(
    step_sec, stalled_share, is_right
):
    times, parts = evenly(1.0, step_sec=step_sec)
    arrived = [i for i in range(len(times)) if i % 500 < 400]  # a full queue loses some
    times, parts = ([each[i] for i in arrived] for each in (times, parts))
    reported = report(parts, times, Wall(stalled_share))
    with contextlib.nullcontext() if is_right else pytest.raises(CheckFailed, match='no step'):
        reported.expect_enough()


@pytest.mark.parametrize(('silent_sec', 'is_right'), [(0.3, True), (0.4, False)])
def test_feedback_has_to_come_from_the_start_of_the_move_on(silent_sec, is_right):
    times, parts = evenly(20.0)
    first = round(silent_sec * 1e9 / STEP_NS)
    reported = report(parts[first:], times[first:], DRIVEN)
    reported.expect_enough()
    told = []
    try:
        reported.expect_steady()
    except CheckFailed as failure:
        told.append(str(failure))
    assert ['from the start of the move' in each for each in told] == [True] * (not is_right)


def test_a_short_move_that_begins_late_has_as_much_feedback_as_a_long_one():
    times, parts = evenly(3.0)
    reported = report(parts, [5.0 + each for each in times], DRIVEN)
    reported.expect_enough()
    reported.expect_steady()


@pytest.mark.parametrize(('copies', 'is_right'), [(2, True), (4, True), (10, False)])
def test_feedback_may_repeat_a_position_but_not_for_long(copies, is_right):
    times, parts = evenly(20.0)
    told = [parts[i - i % copies] for i in range(len(parts))]
    found = ''
    try:
        report(told, times, DRIVEN).expect_steady()
    except CheckFailed as failure:
        found = str(failure)
    assert ('the same position is published' in found) == (not is_right)
    assert bool(found) == (not is_right)


LINE_BEGIN, LINE_END = (0.2, -0.1), (1.2, -0.7)


@pytest.mark.parametrize(
    ('begin', 'end', 'why'),
    [
        (LINE_BEGIN, (1.2, 0.7), 'move both joints by the same part'),
        ((0.2, 0.1), (1.2, 0.7), 'the sign of joint2 is wrong'),
        ((-0.2, -0.1), (-1.2, -0.7), 'the sign of joint1 is wrong'),
        ((-0.2, 0.1), (-1.2, 0.7), 'both signs are wrong'),
        ((-0.1, 0.2), (-0.7, 1.2), 'the joints are swapped'),
        ((0.0, 0.0), LINE_END, 'start from where the arm is'),
    ],
)
def test_positions_beside_the_line_are_explained_by_the_mistake_that_they_show(begin, end, why):
    positions = np.linspace(begin, end, 9)
    assert off_line(positions, LINE_BEGIN, LINE_END).max() > ON_LINE_RAD
    assert why in why_off_line(positions, LINE_BEGIN, LINE_END)


def test_positions_on_the_line_are_not_off_it():
    positions = np.linspace(LINE_BEGIN, LINE_END, 9)
    assert off_line(positions, LINE_BEGIN, LINE_END).max() < 1e-9


WAYS = np.array([[-0.1, 0.3], [-0.2, 0.6], [-0.3, 0.9]])
END_BELOW = -0.4, 1.2


@pytest.mark.parametrize(
    ('told', 'hint'),
    [
        ([0.9, 0.6, 0.3], ''),
        ([0.902, 0.598, 0.302], ''),
        ([0.908, 0.6, 0.3], ''),
        ([0.905, 0.605, 0.305], 'behind the step'),
        ([-0.9, -0.6, -0.3], 'it is a distance'),
        ([0.3, 0.2, 0.1], 'it is the distance of the one joint'),
        ([1.2, 0.8, 0.4], 'not the sum'),
        ([0.5, 0.5, 0.5], 'compute it from the goal'),
    ],
)
def test_remaining_is_the_distance_of_the_joint_farthest_from_its_goal(told, hint):
    found = ''
    try:
        expect_remaining(np.array(told), WAYS, start=(0.0, 0.0), end=END_BELOW)
    except CheckFailed as failure:
        found = str(failure)
    assert hint in found
    assert bool(found) == bool(hint)


def test_advice_names_no_cause_if_two_mistakes_would_explain_remaining():
    with pytest.raises(CheckFailed, match='of the joint that is farthest away, in either'):
        expect_remaining(
            np.array([0.3, 0.2, 0.1]), -WAYS, start=(0.0, 0.0), end=[-each for each in END_BELOW]
        )


@pytest.mark.parametrize(
    ('seen', 'why'),
    [
        ([1.191, -0.595], NOT_THERE),
        ([1.2, -0.6], 'do not round the positions'),
        ([math.degrees(1.234), math.degrees(-0.567)], IN_DEGREES),
        ([0.3, 1.5], ELSEWHERE),
    ],
)
def test_a_result_that_is_a_little_off_is_not_taken_for_one_of_wrong_units(seen, why):
    assert why_off(seen, [1.2, -0.6] if why == NOT_THERE else [1.234, -0.567], start=()) == why
