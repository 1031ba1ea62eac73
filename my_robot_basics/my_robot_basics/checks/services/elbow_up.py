"""What a client of `/solve_ik` publishes: the elbow-up pose of each response, once."""

import math
from collections.abc import Sequence
from typing import Any

from sensor_msgs.msg import JointState

from arm_interfaces.srv import SolveIK
from my_robot_basics.checks.services.servers import Server
from my_robot_basics.checks.values import joints
from my_robot_basics.checks.values.solutions import is_for, request, solve
from my_robot_basics.feedback.errors import expect

EACH_TARGET = (
    'ask for each target, also for one that comes while the answer to another is not there yet'
)
AS_IT_IS = 'publish the angles of response.elbow_up as they are: they are in radians'
AS_ARRIVED = 'put the point that arrived into request.target, as is'
EACH_ANSWER = (
    'publish for each answer, though two requests are under way at once: add_done_callback for '
    'each future, or a list that keeps all of them'
)


def expect_elbow_up(server: Server, x: float, y: float) -> None:
    """Expect the client to publish the elbow-up pose in the server's response for a target."""
    expect_each_elbow_up(server, (x, y))


def expect_each_elbow_up(server: Server, *targets: tuple[float, float]) -> None:
    """Expect the client to publish the elbow-up pose of each target, in any order, and no more.

    Targets are (x, y) in metres. Raises CheckFailed.
    """
    for target in targets:
        _expect_pose(server, *target, beside=[each for each in targets if each != target])
    expect_no_others(server)


def _expect_pose(
    server: Server, x: float, y: float, *, beside: Sequence[tuple[float, float]]
) -> None:
    """Expect the pose of one target; those of the targets `beside` it may come before it."""
    right = joints.in_radians(_degrees(server.answer(request(x, y)).elbow_up))

    def why_wrong(message: Any) -> str:
        if any(is_elbow_up(message, server.answer(request(*other))) for other in beside):
            was_asked = any(is_for(asked, x, y) for asked in server.requests)
            return EACH_ANSWER if was_asked else EACH_TARGET
        if any(is_elbow_up(message, server.answer(asked)) for asked in _other_requests(server)):
            return AS_ARRIVED
        # it is unknown for which target the message is
        reasons = [_why_wrong(server, message, request(*each)) for each in [(x, y), *beside]]
        return next((each for each in reasons if each != AS_IT_IS), AS_IT_IS)

    server.expect(
        lambda message: _is_pose(joints.pose(message), right),
        expected=f'the elbow-up pose {right}',
        hint=why_wrong,
        cause='a target is left without its pose' if beside else '',
    )


def _why_wrong(server: Server, message: Any, asked: SolveIK.Request) -> str:
    response, seen = server.answer(asked), joints.pose(message)
    if _agree(seen, response.elbow_down):
        return 'this is elbow_down: publish the angles of response.elbow_up'
    if _agree(seen, solve(asked).elbow_up):
        return 'publish the angles of the response, not a solution of your own'
    if _agree(seen, _degrees(response.elbow_up)):
        return 'these are degrees: publish the angles of response.elbow_up as they are, in radians'
    why = joints.why_wrong(message, _degrees(response.elbow_up))
    # the response is in radians: a client converts nothing
    return AS_IT_IS if joints.tells_to_convert(why) else why


def _other_requests(server: Server) -> list[Any]:
    """The requests for no target that was published."""
    targets = [(each.x, each.y) for each in server.published]
    return [asked for asked in server.requests if not any(is_for(asked, *at) for at in targets)]


def expect_no_others(server: Server) -> None:
    """Expect that the client has published only elbow-up poses of responses, one for each.

    No pose may come more often than its target was published. Raises CheckFailed.
    """
    server.made.expect_no_others(is_elbow_up, hint=lambda message: why_other(server, message))
    messages, targets = server.made.messages(), [(each.x, each.y) for each in server.published]
    for target in set(targets):
        response = server.answer(request(*target))
        times = sum(is_elbow_up(message, response) for message in messages)
        expect(
            times <= targets.count(target),
            expected='the pose of each target once',
            seen=f'one {times} times',
            hint='ask once for each target, when it arrives, and not in a timer; publish each '
            'answer once',
            cause='a pose is published again and again',
        )


def why_other(server: Server, message: Any) -> str:
    """Advice for a message that belongs to no response, or that comes a second time."""
    seen = joints.pose(message)
    if not isinstance(message, JointState):
        return joints.OTHER_TYPE
    if any(_agree(seen, response.elbow_down) for response in server.sent):
        return 'this is elbow_down: publish the angles of response.elbow_up alone'
    if any(_agree(seen, solve(asked).elbow_up) for asked in server.requests):
        return 'publish the angles of the response, not a solution of your own, and once'
    return 'publish the angles of response.elbow_up once, and nothing else'


def is_elbow_up(message: Any, response: Any) -> bool:
    """Whether a message is the elbow-up pose of a response."""
    return _agree(joints.pose(message), response.elbow_up)


def _agree(seen: dict[str, float], position: Sequence[float]) -> bool:
    right = joints.in_radians(_degrees(position))
    return bool(right) and _is_pose(seen, right)


def _is_pose(seen: dict[str, float], right: dict[str, float]) -> bool:
    """Whether a message has exactly the right joints, each at its right position."""
    return seen.keys() == right.keys() and joints.agree(seen, right)


def _degrees(position: Sequence[float]) -> list[float]:
    return [math.degrees(angle) for angle in position]
