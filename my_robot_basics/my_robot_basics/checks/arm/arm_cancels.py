"""Whether a cancelled goal of `/move_arm` stops the arm, and leaves it ready for the next goal."""

import time
from typing import Any, NoReturn

from my_robot_basics.checks.actions.accepted_goals import expect_accepted
from my_robot_basics.checks.actions.action_ends import SentGoal, cancels
from my_robot_basics.checks.actions.actions import Action
from my_robot_basics.checks.actions.open_action import BLOCKED
from my_robot_basics.checks.arm import arm_stops
from my_robot_basics.checks.arm.arm_looks import look
from my_robot_basics.checks.arm.arm_progress import is_under_way
from my_robot_basics.checks.arm.arm_results import expect_result, is_near
from my_robot_basics.checks.arm.cancel_moments import moment_to_cancel
from my_robot_basics.checks.arm.slow_moves import wait_unless_it_crawls
from my_robot_basics.checks.arm.speed_hints import why_speed
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, far_rad, goal
from my_robot_basics.feedback.errors import CheckFailed, expect, fail

STOP_SEC = 0.2
SLACK_SEC, WALL_SLACK_SEC = 0.06, 0.15
"""Added to STOP_SEC: a step of the driven clock; how late a thread may be on the wall clock."""
REST_SEC, WALL_REST_SEC = 2.0, 0.6
"""How long to wait after a cancelled goal: an arm that moves on is elsewhere by then."""
NEXT_SPEED, NEXT_LEAST_RAD = 0.4, 0.1
EARLY_PART = 0.6
"""A move that ends before this part of its time was stopped."""
MOST_TIMES, MORE_SEC = 3.0, 1.0
ANSWER_SEC = 5.0
"""How long to wait for the answer of a server that gives it only when the move has ended."""
TENTHS, TENTH_NS = 8, 100_000_000
"""A node that published feedback in so many tenths of a second had time to answer, too."""


def expect_cancels(
    action: Action,
    position: Pose,
    *,
    speed: float,
    start: Pose = (0.0, 0.0),
) -> None:
    """Cancel a goal in the middle of its move, and expect the arm to stop within 0.2 s.

    Its status has to be canceled, its result has to hold where the arm stopped, and the next move
    has to begin there and must not be stopped, too. Raises CheckFailed.
    """

    def stops(arm: WatchedArm) -> None:
        sent = arm.send(arm.goal(position, speed=speed))
        wanted_sec = far_rad(arm.start, position) / sent.goal.speed
        cancel_sec = moment_to_cancel(wanted_sec, is_driven=arm.time.is_driven)
        arm.time.let_pass(sent.is_over, seconds=cancel_sec)
        expect(
            not sent.is_over(),
            expected=f'a move that takes {wanted_sec:.1f} s',
            seen='it over before it could be cancelled',
            hint=(sent.is_over() and arm.why_ended(sent))
            or why_speed(arm, position, sent.goal.speed, seconds=arm.seconds(sent)),
            cause='the move is over too soon to be cancelled',
        )
        _cancel(arm, sent, wanted_sec=wanted_sec)
        expect_result(arm, sent)
        arm_stops.expect_canceled(arm, sent)
        arm.time.let_pass(lambda: False, seconds=REST_SEC if arm.time.is_driven else WALL_REST_SEC)
        began, stopped = arm.start, list(sent.result.position)
        if stopped:
            arm_stops.expect_on_the_way(arm, sent, position, start=began)
        # without a result, the next move still has to have the time for its way
        arm.start = tuple(stopped) or arm_stops.last_told(sent, began)
        moved = _expect_moves_on(arm, began, former=sent if stopped else None)
        # if the next result is empty, too, another check reports that
        if not stopped and moved.result is not None and moved.result.position:
            arm_stops.expect_on_the_way(arm, sent, position, start=began)

    look(action, stops, start=start)


def expect_late_cancel(action: Action, position: Pose, *, start: Pose = (0.0, 0.0)) -> None:
    """Expect that a request to cancel after a goal's end changes neither it nor the next goal.

    Raises CheckFailed.
    """

    def outlasts(arm: WatchedArm) -> None:
        sent = arm.send(arm.goal(position, speed=2.0))
        most_sec = MOST_TIMES * far_rad(arm.start, position) + MORE_SEC
        if not arm.time.wait(sent.is_over, seconds=most_sec):
            if not is_under_way(arm, sent, position):
                _fail_without_end(arm, sent, most_sec)
            arm.settle()
        ended = sent.status
        arm.server.answer_to(arm.server.ends.cancel(sent), what='a request to cancel that is late')
        expect(
            sent.status == ended,
            expected=f'a goal that is over to stay {ended}',
            seen=f'it {sent.status} after a late request to cancel',
            hint='a goal ends only once: change nothing about it afterwards',
            cause='a late request to cancel changes a goal',
        )
        back, arm.start = arm.start, tuple(position)
        _expect_moves_on(arm, back)

    look(action, outlasts, start=start)


def _cancel(arm: WatchedArm, sent: SentGoal, *, wanted_sec: float) -> None:
    """Cancel a goal: the request is accepted and the goal ends in time. Raises CheckFailed."""
    began_ns = arm.time.now_ns()
    asked_ns, asked = time.time_ns(), arm.server.ends.cancel(sent)
    arm.server.watcher.spin_until_free(asked.done, free_sec=ANSWER_SEC)
    was_over = sent.is_over()
    response = arm.server.answer_to(asked, what='the request to cancel')
    if not cancels(response, sent):
        went_on = _went_on_without_answer(sent, asked_ns)
        _fail_refused(arm, response, was_over=was_over, went_on=went_on)
    slack_sec = SLACK_SEC if arm.time.is_driven else WALL_SLACK_SEC
    if arm.time.wait(sent.is_over, seconds=STOP_SEC + slack_sec):
        return
    if not arm.time.wait(sent.is_over, seconds=MOST_TIMES * wanted_sec):
        arm.server.fail_without_end(
            sent,
            it=f'it {sent.status} after the request to cancel was accepted',
            none='none after the request to cancel was accepted',
        )
    over_sec = (arm.time.at_ns(sent.over_ns()) - began_ns) / 1e9
    hint = 'look at goal_handle.is_cancel_requested in each step, and take steps more often'
    if sent.status != 'canceled':
        hint = (
            'the move goes on in spite of the request: look at goal_handle.is_cancel_requested in '
            'each step, and if it is True, call goal_handle.canceled() and return the result'
        )
    fail(
        expected=f'the goal to be canceled within {STOP_SEC} s',
        seen=f'it {sent.status} after {over_sec:.1f} s',
        hint=hint,
        cause='the arm does not stop in time',
        doubt=arm.doubt(),
    )


def _fail_without_end(arm: WatchedArm, sent: SentGoal, most_sec: float) -> NoReturn:
    it, none = f'it {sent.status} in {most_sec:.0f} s', f'none in {most_sec:.0f} s'
    arm.server.fail_without_end(sent, it=it, none=none)


def _went_on_without_answer(sent: SentGoal, asked_ns: int) -> bool:
    """Whether feedback came for long after a request to cancel that was not answered meanwhile.

    Then the node had enough processor time to answer, however busy the machine was.
    """
    since = [sent_ns - asked_ns for sent_ns, _ in sent.feedback()]
    return len({each // TENTH_NS for each in since if each > 0}) >= TENTHS


def _fail_refused(arm: WatchedArm, response: Any, *, was_over: bool, went_on: bool) -> None:
    if was_over or response.return_code == response.ERROR_GOAL_TERMINATED:
        fail(
            expected='an answer to the request to cancel while the arm moves',
            seen='it at the end of the move',
            hint=BLOCKED,
            cause='a request to cancel is answered too late',
            doubt=CheckFailed if went_on else arm.doubt(),
        )
    fail(
        expected='the request to cancel to be accepted',
        seen='it rejected',
        hint='give ActionServer a cancel_callback that returns CancelResponse.ACCEPT: without '
        'one, rclpy rejects every request',
        cause='a request to cancel is rejected',
    )


def _expect_moves_on(
    arm: WatchedArm, position: Pose, *, former: SentGoal | None = None
) -> SentGoal:
    """Send the next goal: it is accepted, begins where `former` stopped, and is not stopped."""
    far = max(far_rad(arm.start, position), NEXT_LEAST_RAD)
    sent = expect_accepted(arm.server, goal(position, speed=max(NEXT_SPEED, far / 2.0)))
    wanted_sec = far / sent.goal.speed
    most_sec = MOST_TIMES * wanted_sec + MORE_SEC
    ends = wait_unless_it_crawls(arm, sent, position, seconds=most_sec)
    if ends:
        arm.has_result(sent)
    elif not is_under_way(arm, sent, position):
        _fail_without_end(arm, sent, most_sec)
    if former is not None:
        arm_stops.expect_begins_at(arm, list(former.result.position), sent, former=former)
    is_early = ends and arm.seconds(sent) < EARLY_PART * wanted_sec
    is_there = sent.result is not None and is_near(list(sent.result.position), position)
    if is_early and sent.feedback() and is_there:
        return sent  # it has arrived, so it was not stopped: another check is about its speed
    expect(
        sent.status != 'canceled' and not is_early,
        expected='the next goal to be reached',
        seen=f'it {sent.status} too soon' if is_early else f'it {sent.status} in the end',
        hint='a request to cancel is for one goal: forget it when the next one begins',
        cause='the next goal is stopped, too',
    )
    return sent
