"""Whether a client takes a message in a response of `/solve_ik` for a refusal."""

from collections.abc import Callable
from typing import Any

from arm_interfaces.srv import SolveIK
from my_robot_basics.checks.servers import Server
from my_robot_basics.feedback.errors import CheckFailed, fail

WITHIN_REACH = 'within reach'
"""A message that a server may send with angles: only `reachable` says whether there are any."""


def expect_heeds_reachable(server: Server, expect_answer: Callable[[], None]) -> None:
    """Expect the client to publish the pose though the response has a message, too.

    `expect_answer` asks the client for a target within reach, and expects its pose. Raises
    CheckFailed.
    """
    answer, asked = server.answer, len(server.requests)
    published = len(server.made.messages())

    def answer_with_message(request: Any) -> SolveIK.Response:
        response = answer(request)
        response.message = WITHIN_REACH
        return response

    server.answer = answer_with_message
    try:
        expect_answer()
    except CheckFailed:
        if len(server.requests) > asked and len(server.made.messages()) == published:
            fail(
                expected='the elbow-up pose, though response.message holds a text, too',
                seen='none; it came while response.message was empty',
                hint='look at response.reachable: response.message may hold any text',
                cause='a message is taken for a refusal',
            )
        raise
    finally:
        server.answer = answer
