"""What a client of `/solve_ik` publishes: the elbow-up pose of each response, once."""

import math
from collections.abc import Sequence
from typing import Any

from my_robot_basics.checks import joints
from my_robot_basics.checks.servers import Server
from my_robot_basics.checks.solutions import request, solve


def expect_elbow_up(server: Server, x: float, y: float) -> None:
    """The client publishes the elbow-up pose that the server answers for a target."""
    response = server.answer(request(x, y))
    up_deg, down_deg = (
        [math.degrees(angle) for angle in branch]
        for branch in (response.elbow_up, response.elbow_down)
    )
    right = joints.in_radians(up_deg)

    def why_wrong(message: Any) -> str:
        if joints.agree(joints.pose(message), joints.in_radians(down_deg)):
            return 'this is elbow_down: publish the angles of response.elbow_up'
        own_deg = [math.degrees(angle) for angle in solve(request(x, y)).elbow_up]
        if own_deg and joints.agree(joints.pose(message), joints.in_radians(own_deg)):
            return 'publish the angles of the response, not a solution of your own'
        return joints.why_wrong(message, up_deg)

    server.expect(
        lambda message: joints.agree(joints.pose(message), right),
        expected=f'the elbow-up pose {right}',
        hint=why_wrong,
    )
    expect_no_others(server)


def expect_no_others(server: Server) -> None:
    """What the client has published are the elbow-up poses of responses, each of another one.

    Raises CheckFailed.
    """

    def why_wrong(message: Any) -> str:
        seen = joints.pose(message)
        if any(_agree(seen, response.elbow_down) for response in server.sent):
            return 'this is elbow_down: publish the angles of response.elbow_up alone'
        if any(_agree(seen, solve(asked).elbow_up) for asked in server.requests):
            return 'publish the angles of the response, not a solution of your own, and once'
        return 'publish the angles of response.elbow_up once, and nothing else'

    server.made.expect_no_others(is_elbow_up, hint=why_wrong)


def is_elbow_up(message: Any, response: Any) -> bool:
    """Whether a JointState is the elbow-up pose of a response."""
    return _agree(joints.pose(message), response.elbow_up)


def _agree(seen: dict[str, float], position: Sequence[float]) -> bool:
    right = joints.in_radians([math.degrees(angle) for angle in position])
    return bool(right) and joints.agree(seen, right)
