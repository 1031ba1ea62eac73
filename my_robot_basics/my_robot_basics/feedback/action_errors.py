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
)
