"""Hints for exceptions in coroutines and in the callbacks of action servers; as in error_words."""

from my_robot_basics.feedback.error_words import Case

OF_ACTIONS = (
    Case(
        pattern='no running event loop',
        to_do=', so wait without asyncio, whose event loop does not run here: await a Future of '
        'rclpy that a timer sets',
    ),
    Case(
        pattern='from state EXECUTING with event CANCELED',
        to_do=', so call canceled() in the execute callback, after the cancel callback has '
        'returned CancelResponse.ACCEPT',
    ),
    Case(
        pattern='from state (?:SUCCEEDED|CANCELED|ABORTED) with event',
        to_do=', so call only one of succeed(), canceled() and abort() for each goal, and call it '
        'once',
    ),
    Case(
        pattern=r'KeyError: 0 \(.*\.status\b',
        to_do=', so look at goal_handle.accepted first: a rejected goal has no result, and its '
        'status is 0',
    ),
    Case(
        # the future of a result, too early, or after its cancel()
        pattern=r"'NoneType' object has no attribute 'status'.*\.result\(\)",
        to_do=', so let add_done_callback call this function, and cancel the goal with '
        'cancel_goal_async(), not its future: a future that was cancelled has no result',
    ),
)
