"""Goals for `/move_arm` that have to be accepted, and why they are not."""

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.actions.goal_answers import GoalAnswers, note_why_rejected
from my_robot_basics.checks.actions.open_action import OpenAction
from my_robot_basics.feedback.errors import fail


def expect_accepted(server: OpenAction, wanted: MoveArm.Goal, *others: MoveArm.Goal) -> SentGoal:
    """Send a goal that has to be accepted; if it is rejected, try the `others` in their order.

    Return the goal that was accepted. If none was, raise CheckFailed with the reason why the
    first one was rejected.
    """
    former = server.accepted[-1] if server.accepted else None
    before = server.answers()
    first = sent = server.send(wanted)
    for other in others:
        if not sent.is_accepted:
            sent = server.send(other)
    if not sent.is_accepted:
        hint = before.why_rejected or _why_rejected(server, first, former, before)
        note_why_rejected(server.identity(), hint)
        shown = [round(each, 3) for each in wanted.position]
        fail(
            expected=f'the goal {shown} at {wanted.speed:.3g} rad/s to be accepted',
            seen='it rejected',
            hint=hint,
            cause='a goal within the limits is rejected',
        )
    return sent


def ends_too_soon() -> str:
    """Advice if the arm moves on after the server has published how the goal ended."""
    return (
        'the arm moves on after the goal has ended: call goal_handle.succeed() when the arm is '
        'there, after the loop that moves it'
    )


def never_moves() -> str:
    """Advice if a goal succeeds at once, and the arm is still where it was."""
    return (
        'the goal ends at once, and the arm stays where it was: the loop of the execute callback '
        'does not run, so see that its condition holds when each goal begins, the second one, too'
    )


def _why_rejected(
    server: OpenAction, sent: SentGoal, former: SentGoal | None, before: GoalAnswers
) -> str:
    if server.log.had_no_response(since_ns=sent.sent_ns):
        return 'end the goal callback with `return GoalResponse.ACCEPT` or `GoalResponse.REJECT`'
    accepted_ns = before.accepted_ns or _first_accepted_ns(server)
    if accepted_ns and (raised := server.log.raised(since_ns=accepted_ns)):
        return raised
    if former is None and server.ends.has_active():
        return (
            'an earlier goal was accepted, and has not ended: its execute callback has to return, '
            'and a handle_accepted_callback calls goal_handle.execute()'
        )
    if former is None and server.ends.feedback.received:  # for a goal from an earlier cell
        return ends_too_soon()
    if former is not None and any(0 < former.over_ns() < at_ns for at_ns, _ in former.feedback()):
        return ends_too_soon()
    if before.has_rejected_last:
        return (
            'return GoalResponse.ACCEPT for two angles within the limits (in rad) and a speed > '
            '0, and let a goal that you reject change nothing in the node'
        )
    if accepted_ns:
        return (
            'the goal before it was accepted, and has ended: see that the node knows that the arm '
            'moves no longer, and that both positions are compared with their own limits, in rad'
        )
    return 'return GoalResponse.ACCEPT for two angles within the limits (in rad) and a speed > 0'


def _first_accepted_ns(server: OpenAction) -> int:
    """When the server accepted the oldest goal that it reports, whoever sent it; 0 if none.

    In ns of its node's clock.
    """
    stamps = [
        each.goal_info.stamp
        for message in server.ends.statuses.messages()
        for each in message.status_list
    ]
    return min((stamp.sec * 10**9 + stamp.nanosec for stamp in stamps), default=0)
