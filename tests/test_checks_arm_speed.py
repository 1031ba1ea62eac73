"""A speed has to be exact to 2 % of a robot minute, on any machine."""

import contextlib
import itertools
import math
import random
from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed, moves
from my_robot_basics.checks.arm import arm_speed
from my_robot_basics.checks.arm.arm_cancels import _went_on_without_answer
from my_robot_basics.checks.arm.watched_arm import WatchedArm
from my_robot_basics.checks.clock.robot_time import DrivenTime
from my_robot_basics.feedback.errors import Starved

from arm_interfaces.action import MoveArm

MINUTE = (1.2, -0.6)
SPEED = 0.02
IN_FINER_STEPS = arm_speed._is_right_in_finer_steps


def judge(seconds, *, speed=SPEED, reported=(), is_driven=True, stalled_sec=0.0, lost_sec=0.0):
    """Judge a move of this duration, which finer steps show, too; `reported` are (s, rad).

    A third number there is the position of joint2, which is half of joint1's by default.
    """
    arm = SimpleNamespace(
        start=(0.0, 0.0),
        time=SimpleNamespace(is_driven=is_driven, at_ns=lambda sent_ns: sent_ns),
        seconds=lambda sent: seconds,
        lost_sec=lost_sec,
        stalled_sec=lambda: stalled_sec,
        doubt=lambda: Starved if stalled_sec else CheckFailed,
        why_too_soon=lambda sent: '',
    )
    told = [
        (round(at * 1e9), MoveArm.Feedback(position=[q, *(second or (-q / 2,))]))
        for at, q, *second in reported
    ]
    sent = SimpleNamespace(goal=moves.goal(MINUTE, speed=speed), feedback=lambda: told)
    arm_speed.expect_speed(arm, sent, MINUTE)


def reports(speed, *, seconds, step_sec=0.05, late_sec=(0.0,)):
    """Feedback of a server that computes each position from its clock, and may send late."""
    late = itertools.cycle(late_sec)
    times = [step_sec * step + next(late) for step in range(round(seconds / step_sec))]
    return [(at, speed * at) for at in times]


def steps(speed, *, seconds, step_sec=0.05, late_sec):
    """The feedback of a loop that adds up steps, and sleeps longer than requested."""
    late, at, found = itertools.cycle(late_sec), 0.0, []
    for step in range(round(seconds / step_sec)):
        found.append((at, speed * step_sec * step))
        at += step_sec + next(late)
    return found


@pytest.fixture(autouse=True)
def _slow_in_finer_steps_too(monkeypatch):
    monkeypatch.setattr(arm_speed, '_is_right_in_finer_steps', lambda *_: False)


@pytest.mark.parametrize('seconds', [58.9, 60.0, 61.2])
def test_a_duration_within_two_percent_passes(seconds):
    judge(seconds)


@pytest.mark.parametrize('seconds', [61.5, 58.8])
def test_time_lost_to_coarse_steps_widens_the_tolerance(seconds):
    judge(seconds, lost_sec=0.25)


@pytest.mark.parametrize(
    ('seconds', 'hint'),
    [
        (58.0, 'in each step, move by speed'),
        (62.0, 'in each step, move by speed × the time that passed'),
        (60.0 / 57.29578, 'the speed is in rad/s already'),
        (60.0 * 57.29578, 'the speed is in rad/s already'),
        (60.0 * 1.25**0.5, 'the speed is that of the faster joint'),
        (90.0, 'both joints move at once'),
        (30.0, 'the speed is that of the joint that has farther to go'),
        (0.05, 'the arm jumps'),
    ],
)
def test_a_wrong_speed_fails_with_its_likely_cause(seconds, hint):
    with pytest.raises(CheckFailed, match=hint):
        judge(seconds)


# --- the speed that feedback shows ---------------------------------------------------------------

BRIEF_SEC = 1.6
BRIEF = 1.2 / BRIEF_SEC
"""The speed of a move on the wall clock."""
BUSY = 0.004, 0.001, 0.03, 0.002, 0.0, 0.012


@pytest.mark.parametrize('off', [-0.018, 0.0, 0.018])
def test_a_short_move_within_two_percent_by_its_feedback_passes(off):
    told = reports(0.5 * (1.0 + off), seconds=2.4)
    judge(2.4 / (1.0 + off), speed=0.5, reported=told)


@pytest.mark.parametrize('off', [-0.025, 0.025])
def test_a_short_move_off_by_more_than_two_percent_fails_by_its_feedback(off):
    told = reports(0.5 * (1.0 + off), seconds=2.4)
    with pytest.raises(CheckFailed, match=r'expected 2.40 s .* saw 2.[34]\d s: in each step'):
        judge(2.4 / (1.0 + off), speed=0.5, reported=told)


def test_a_move_in_time_that_is_slow_at_both_ends_is_told_its_speed_and_no_other_time():
    times = [0.05 * step for step in range(1200)]
    told = [(at, 0.6 * (1.0 - math.cos(math.pi * at / 60.0))) for at in times]
    with pytest.raises(CheckFailed, match=r'expected 60\.0 s .* saw 0\.02\d+ rad/s for the most'):
        judge(60.0, reported=told)


@pytest.mark.parametrize('is_right', [True, False])
def test_late_first_messages_are_judged_again_in_finer_steps(monkeypatch, is_right):
    monkeypatch.setattr(arm_speed, '_is_right_in_finer_steps', lambda *_: is_right)
    half = reports(BRIEF, seconds=BRIEF_SEC / 2)
    late = [(at + 0.05 * (step < len(half) / 2), q) for step, (at, q) in enumerate(half)]
    fast = pytest.raises(CheckFailed, match=r'saw 1\.5 s: in each step')
    with contextlib.nullcontext() if is_right else fast:
        judge(BRIEF_SEC, speed=BRIEF, reported=late)


def test_a_move_that_ends_too_soon_fails_even_if_right_in_finer_steps(monkeypatch):
    monkeypatch.setattr(arm_speed, '_is_right_in_finer_steps', lambda *_: True)
    with pytest.raises(CheckFailed, match=r'expected 60\.0 s'):
        judge(58.0)


@pytest.mark.parametrize(
    ('seconds', 'why'),
    [(62.0, 'rest nowhere, and end'), (67.08, 'rest nowhere'), (90.0, 'both joints move at once')],
)
def test_an_arm_that_moves_at_the_right_speed_and_ends_late_is_told_so(seconds, why):
    told = reports(SPEED, seconds=60.0)
    with pytest.raises(CheckFailed, match=f'saw {seconds:.1f} s: .*{why}'):
        judge(seconds, reported=told)


@pytest.mark.parametrize('speed', [SPEED, 0.9 * SPEED])
def test_an_arm_that_tells_the_right_speed_gets_a_longer_move_in_finer_steps(monkeypatch, speed):
    """A rest of a tenth of its time is shorter than the slack of a move of half a second."""
    tried = []
    monkeypatch.setattr(
        arm_speed, '_is_right_in_finer_steps', lambda *args: tried.append(args[-1]) or True
    )
    judge(66.0, reported=reports(speed, seconds=66.0))
    assert tried == [arm_speed.FINER if speed == SPEED else arm_speed.FINEST]


@pytest.mark.parametrize(
    ('took_sec', 'told_rad_per_sec', 'slowness'),
    [(4.1, 0.3, 1.0), (4.52, 0.3, 1.1), (4.1, 0.25, 1.2), (4.52, 0.0, 1.1), (3.48, 0.0, 0.9)],
    ids=['right', 'rests', 'slow', 'rests and tells nothing', 'fast and tells nothing'],
)
def test_a_move_in_finer_steps_is_slow_if_it_ends_late(
    monkeypatch, took_sec, told_rad_per_sec, slowness
):
    sent = SimpleNamespace(is_over=lambda: True, goal=moves.goal(MINUTE, speed=0.3))
    arm = SimpleNamespace(
        start=(0.0, 0.0),
        time=SimpleNamespace(wait=lambda *_, **__: True),
        goal=moves.goal,
        send=lambda goal: sent,
        seconds=lambda sent: took_sec,
    )
    told = SimpleNamespace(rad_per_sec=told_rad_per_sec)
    monkeypatch.setattr(arm_speed, 'reported_speed', lambda *_: told)
    assert arm_speed._slowness(arm, MINUTE, seconds=4.0) == pytest.approx(slowness)


@pytest.mark.parametrize(
    ('slowest_rad_per_sec', 'times', 'is_right'),
    [(0.0, 1.5, True), (0.15, 1.15, False), (10.0, 1.15, False), (0.15, 0.5, True)],
    ids=['at no speed', 'at that speed', 'at every speed', 'stops a little before its goal'],
)
def test_finer_steps_show_whether_a_server_is_slow_at_that_speed_alone(
    monkeypatch, slowest_rad_per_sec, times, is_right
):
    """One that rounds the speed down to whole degrees per second had all points."""
    told = [(n, MoveArm.Feedback(position=[0.0, 0.0])) for n in range(600)]
    sent = SimpleNamespace(goal=moves.goal(MINUTE, speed=SPEED), feedback=lambda: told)
    time = object.__new__(DrivenTime)
    time.step_ns = 50_000_000
    arm = SimpleNamespace(start=(0.0, 0.0), time=time, seconds=lambda sent: 60.0)

    went = []

    def slowness(arm, position, *, seconds):
        went.append(position)
        return times if abs(position[0]) / seconds < slowest_rad_per_sec else 1.0

    monkeypatch.setattr(arm_speed, 'bring', lambda arm, position: went.append(position))
    monkeypatch.setattr(arm_speed, '_slowness', slowness)
    monkeypatch.setattr(arm_speed, 'reported_speed', lambda *_: SimpleNamespace(rad_per_sec=SPEED))
    assert IN_FINER_STEPS(arm, sent, MINUTE, arm_speed.FINEST) == is_right
    assert time.step_ns == 50_000_000
    if is_right:  # the check goes on from there
        assert went[-1] == MINUTE


@pytest.mark.parametrize(('speed', 'moves_made'), [(2.0, 2), (3.0, 1)])
def test_no_move_in_finer_steps_goes_farther_than_its_goal(monkeypatch, speed, moves_made):
    """At a high speed, the short move is no slower than that: there is nothing more to see."""
    told = [(n, MoveArm.Feedback(position=[0.0, 0.0])) for n in range(60)]
    sent = SimpleNamespace(goal=moves.goal(MINUTE, speed=speed), feedback=lambda: told)
    time, made = object.__new__(DrivenTime), []
    time.step_ns = 50_000_000
    arm = SimpleNamespace(start=(0.0, 0.0), time=time, seconds=lambda sent: 0.4)

    def slowness(arm, position, *, seconds):
        made.append(position)
        return 1.0

    monkeypatch.setattr(arm_speed, 'bring', lambda *_: None)
    monkeypatch.setattr(arm_speed, '_slowness', slowness)
    monkeypatch.setattr(arm_speed, 'reported_speed', lambda *_: SimpleNamespace(rad_per_sec=speed))
    assert IN_FINER_STEPS(arm, sent, MINUTE, arm_speed.FINEST)
    assert len(made) == moves_made
    assert all(0.0 < position[0] <= MINUTE[0] for position in made)


@pytest.mark.parametrize('off', [-0.04, 0.04, 0.1])
@pytest.mark.parametrize('late_sec', [(0.0002, 0.0), BUSY])
def test_a_speed_off_by_four_percent_fails_on_the_wall_clock(off, late_sec):
    told = reports(BRIEF * (1.0 + off), seconds=BRIEF_SEC, late_sec=late_sec)
    with pytest.raises(CheckFailed, match='in each step, move by speed'):
        judge(BRIEF_SEC / (1.0 + off), speed=BRIEF, reported=told, is_driven=False)


@pytest.mark.parametrize('make', [reports, steps])
@pytest.mark.parametrize('late_sec', [(0.0004,), BUSY])
def test_a_right_speed_passes_on_a_busy_machine(make, late_sec):
    told = make(BRIEF, seconds=BRIEF_SEC, late_sec=late_sec)
    took_sec = BRIEF_SEC + (sum(late_sec) / len(late_sec) / 0.05 * BRIEF_SEC)
    judge(took_sec, speed=BRIEF, reported=told, is_driven=False, stalled_sec=1.0)


def test_a_loop_that_sleeps_too_little_is_too_fast():
    told = steps(BRIEF * 1.06, seconds=BRIEF_SEC, late_sec=(0.0003, 0.001))
    with pytest.raises(CheckFailed, match='in each step, move by speed'):
        judge(BRIEF_SEC / 1.06, speed=BRIEF, reported=told, is_driven=False)


def test_wrong_feedback_does_not_count_against_the_speed():
    judge(2.4, speed=0.5, reported=reports(0.5 * 57.3, seconds=0.02, step_sec=0.001))
    judge(2.4, speed=0.5, reported=[(0.1 * step, 1.2) for step in range(20)])


@pytest.mark.parametrize(('times', 'failure'), [(1.05, Starved), (1.3, CheckFailed)])
def test_a_busy_machine_excuses_a_small_error_of_speed_but_no_large_one(times, failure):
    told = reports(BRIEF / times, seconds=BRIEF_SEC * times, late_sec=BUSY)
    with pytest.raises(CheckFailed) as raised:
        judge(BRIEF_SEC * times, speed=BRIEF, reported=told, is_driven=False, stalled_sec=1.0)
    assert raised.type is failure


def one_after_the_other(*, step_sec=0.05):
    """The feedback of an arm whose joint2 moves first, and then joint1."""
    found = []
    for step in range(round(1.5 * BRIEF_SEC / step_sec)):
        gone = BRIEF * step_sec * step
        found.append((step_sec * step, max(0.0, gone - 0.6), -min(gone, 0.6)))
    return found


def with_a_rest(*, from_sec, rest_sec, step_sec=0.05):
    """The feedback of an arm that stands still on its way, and goes on to send feedback."""
    times = [step_sec * step for step in range(round((BRIEF_SEC + rest_sec) / step_sec))]
    return [(at, BRIEF * (min(at, from_sec) + max(0.0, at - from_sec - rest_sec))) for at in times]


@pytest.mark.parametrize(
    ('told', 'times', 'failure'),
    [
        (one_after_the_other(), 1.5, CheckFailed),
        (with_a_rest(from_sec=0.0, rest_sec=BRIEF_SEC / 2), 1.5, Starved),
        (with_a_rest(from_sec=BRIEF_SEC / 2, rest_sec=BRIEF_SEC / 2), 1.5, Starved),
    ],
    ids=['joint2 first', 'a rest at the start', 'a rest on the way'],
)
def test_a_busy_machine_does_not_let_an_arm_rest_that_sends_feedback(told, times, failure):
    with pytest.raises(CheckFailed) as raised:
        judge(BRIEF_SEC * times, speed=BRIEF, reported=told, is_driven=False, stalled_sec=2.0)
    assert raised.type is failure


def test_a_gap_in_the_feedback_on_a_busy_machine_is_no_rest():
    told = with_a_rest(from_sec=0.1, rest_sec=0.5)
    seen = [each for each in told if not 0.12 < each[0] < 0.62]
    judge(BRIEF_SEC + 0.5, speed=BRIEF, reported=seen, is_driven=False, stalled_sec=1.0)


def test_a_slow_loop_on_a_busy_machine_counts_as_starved():
    told = steps(BRIEF, seconds=BRIEF_SEC, late_sec=(0.02, 0.03))
    with pytest.raises(Starved):
        judge(BRIEF_SEC * 1.5, speed=BRIEF, reported=told, is_driven=False, stalled_sec=0.3)


def test_a_busy_machine_does_not_excuse_a_move_that_is_too_fast():
    with pytest.raises(CheckFailed) as raised:
        judge(BRIEF_SEC / 1.5, speed=BRIEF, is_driven=False, stalled_sec=1.0)
    assert raised.type is CheckFailed


def test_short_moves_have_varying_durations():
    arm = WatchedArm(None, None, (0.0, 0.0), 2.0)
    positions = [MINUTE, *(moves.choose(random.Random(seed)) for seed in range(20))]
    goals = [arm.goal(position, speed=SPEED) for position in positions]
    seconds = sorted(abs(goal.position[0]) / goal.speed for goal in goals)
    assert 1.3 <= seconds[0] < 1.45
    assert 1.85 < seconds[-1] <= 2.0
    assert len({round(each, 1) for each in seconds}) >= 6


@pytest.mark.parametrize(('count', 'is_proof'), [(7, False), (20, True)])
def test_feedback_after_a_request_proves_that_the_node_could_have_answered(count, is_proof):
    """On a machine under any load: a node that publishes feedback could also have answered."""
    asked_ns = 10**18
    told = [(asked_ns + step * 50_000_000, None) for step in range(-9, count)]
    sent = SimpleNamespace(feedback=lambda: told)
    assert _went_on_without_answer(sent, asked_ns) is is_proof


@pytest.mark.parametrize(
    ('part', 'goes_on', 'is_slow'),
    [(0.4, True, True), (0.4, False, False), (0.6, True, False), (0.0, True, False)],
    ids=['slow', 'stands still', 'late', 'tells nothing'],
)
def test_a_goal_that_does_not_end_fails_as_slow_by_its_feedback(
    monkeypatch, part, goes_on, is_slow
):
    told = SimpleNamespace(rad_per_sec=part * SPEED)
    monkeypatch.setattr(arm_speed, 'reported_speed', lambda *_: told)
    monkeypatch.setattr(arm_speed, 'is_under_way', lambda *_: goes_on)
    arm = SimpleNamespace(start=(0.0, 0.0))
    sent = SimpleNamespace(goal=moves.goal(MINUTE, speed=SPEED))
    slow = pytest.raises(CheckFailed, match='saw 150 s, as the feedback tells: in each step')
    with slow if is_slow else contextlib.nullcontext():
        arm_speed.expect_no_slow_move(arm, sent, MINUTE)
