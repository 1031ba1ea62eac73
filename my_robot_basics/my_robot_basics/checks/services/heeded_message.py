"""Whether a client takes a message in a response of `/solve_ik` for a refusal."""

from collections.abc import Callable
from typing import Any

from arm_interfaces.srv import SolveIK
from my_robot_basics.checks.services.servers import Server
from my_robot_basics.feedback.errors import CheckFailed, fail

WITHIN_REACH = 'within reach'
"""A message that a server may send with angles: only `reachable` says whether there are any."""


def expect_heeds_reachable(
    server: Server, x: float, y: float, expect_answer: Callable[[float, float], None]
) -> None:
    """Expect the client to publish the pose again, though the response has a message now.

    `expect_answer` asks the client for a target within reach, and expects its pose; the client has
    just published that of (x, y). Raises CheckFailed.
    """
    answer, asked = server.answer, len(server.requests)
    published = len(server.made.messages())

    def answer_with_message(request: Any) -> SolveIK.Response:
        response = answer(request)
        response.message = WITHIN_REACH
        return response

    def is_published(x: float, y: float) -> bool:
        try:
            expect_answer(x, y)
        except CheckFailed:
            return False
        return True

    server.answer = answer_with_message
    try:
        expect_answer(x, y)
    except CheckFailed:
        server.answer = answer
        if len(server.requests) > asked and len(server.made.messages()) == published:
            if is_published(x, y):
                fail(
                    expected='the elbow-up pose, though response.message holds a text, too',
                    seen='none; it came while response.message was empty',
                    hint='look at response.reachable: response.message may hold any text',
                    cause='a message is taken for a refusal',
                )
            if is_published(-x, y):  # as far away, so within reach, too
                fail(
                    expected='the elbow-up pose for each target, also for one that comes again',
                    seen='none for a target that came before',
                    hint='publish each answer once, also if it equals an earlier one',
                    cause='a pose is not published again for the same target',
                )
        raise
    finally:
        server.answer = answer
