"""Checks of a server of `/solve_ik` and of its clients; angles are in radians."""

import itertools
import math
import time
from functools import partial
from typing import Any

from geometry_msgs.msg import Point

from my_robot_basics.checks.services.elbow_up import (
    AS_ARRIVED,
    expect_each_elbow_up,
    expect_elbow_up,
    expect_no_others,
    is_elbow_up,
    why_other,
)
from my_robot_basics.checks.services.heeded_message import expect_heeds_reachable
from my_robot_basics.checks.services.left_over import why_left_over
from my_robot_basics.checks.services.one_more import expect_alive_when_released, publish_one_more
from my_robot_basics.checks.services.servers import Server
from my_robot_basics.checks.services.services import Service
from my_robot_basics.checks.values.branches import DOWN, UP, in_radians, is_pose, why_off
from my_robot_basics.checks.values.solutions import is_for, request, solve
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.session.pressure import Stopwatch
from my_robot_basics.two_link_kinematics import inverse_kinematics

__all__ = ['expect_elbow_up', 'request', 'solve']

MOST_ANGLES = 20
"""How many angles of a branch are looked at: it should have two, but may have millions."""
COUNT_HZ = 10.0
"""The rate of a client's count, which the exercise provides."""
HEIGHTS_M = 0.0, 0.7, -0.7
"""The z of targets, in turn: it does not matter, because the arm moves in a plane."""


def expect_solutions(service: Service, *targets: tuple[float, float]) -> None:
    """Call the service for all targets at once, and expect both branches of each, in radians.

    Targets are (x, y) in metres and within reach; two of three requests have a z, which does not
    matter. Raises CheckFailed.
    """
    heights_m = itertools.cycle(HEIGHTS_M)
    asked = [request(x, y, z=z) for (x, y), z in zip(targets, heights_m, strict=False)]
    for each, response in zip(asked, service.call_all(*asked), strict=True):
        if why := _why_wrong(response, each.target):
            at_zero = request(each.target.x, each.target.y)
            if each.target.z and not _why_wrong(service.call(at_zero), at_zero.target):
                why['hint'] = 'z does not matter: look at x and y of the target alone'
            fail(**why)


def _why_wrong(response: Any, target: Point) -> dict[str, Any]:
    """Arguments for `fail` if the response to a target within reach is wrong; else empty."""
    where = f'the target ({target.x:g}, {target.y:g})'
    if target.z:
        where = f'the target ({target.x:g}, {target.y:g}) with z = {target.z:g}'
    if not response.reachable:
        return {
            'expected': f'reachable to be True for {where}',
            'seen': 'False',
            'hint': 'set response.reachable = True where inverse_kinematics finds solutions (a '
            'bool: 1 and the True of NumPy arrive as False)',
            'cause': 'a target within reach is called unreachable',
        }
    branches_deg = inverse_kinematics(target.x, target.y)
    for branch, other in ((UP, DOWN), (DOWN, UP)):
        position = list(getattr(response, branch)[:MOST_ANGLES])
        if not is_pose(position, branches_deg[branch]):
            rad = in_radians(branches_deg[branch])
            return {
                'expected': f'{branch} of {rad} rad for {where}',
                'seen': shorten([round(angle, 4) for angle in position]),
                'hint': why_off(position, target, branch, other),
                'cause': f'{branch} is wrong',
            }
    return {}


def expect_refusals(service: Service, *targets: tuple[float, float]) -> None:
    """Expect a response to each target that says not reachable, without angles, with a message.

    Targets are (x, y) in metres, out of reach or NaN. Raises CheckFailed.
    """
    for x, y in targets:
        what = 'NaN' if math.isnan(x + y) else 'a target out of reach'
        response = service.call(request(x, y), what=what)
        left_over = why_left_over(service, x, y) if response.elbow_up else ''
        expect(
            not response.reachable,
            expected=f'reachable to be False for ({x:g}, {y:g})',
            seen='True',
            hint=left_over
            or 'inverse_kinematics raises ValueError there: catch it, and leave reachable False',
            cause=f'{what} is called reachable',
        )
        angles = len(response.elbow_up) + len(response.elbow_down)
        expect(
            not angles,
            expected=f'no angles for ({x:g}, {y:g})',
            seen=f'{angles}',
            hint=left_over or 'leave elbow_up and elbow_down empty',
            cause=f'{what} has angles',
        )
        expect(
            bool(response.message.strip()),
            expected=f'a message that says why ({x:g}, {y:g}) is not reachable',
            seen='none',
            hint='set response.message, to the text of the ValueError, say',
            cause=f'{what} has no message',
        )


def expect_answer(server: Server, x: float, y: float) -> None:
    """Expect the client to request a target and publish its elbow-up pose.

    It gets the target twice; the second response has a message, too. Raises CheckFailed.
    """
    _expect_answer(server, x, y)
    expect_heeds_reachable(server, x, y, partial(_expect_answer, server))


def _expect_answer(server: Server, x: float, y: float) -> None:
    ask(server, x, y)
    expect_elbow_up(server, x, y)


def expect_never_blocks(
    server: Server, *targets: tuple[float, float], slow_sec: float = 0.0
) -> None:
    """Expect the client to keep running while it waits for a response, and without a server.

    It has to count at COUNT_HZ, and to publish the poses of three targets within reach. The first
    two arrive while responses are held back, for `slow_sec` or more, and the third when the server
    has come back. A client that asks for one after the other gets one more. Raises CheckFailed.
    """
    first, second, third = targets
    if count := server.record_count():  # a slow count would seem to stand still
        count.assert_rate(COUNT_HZ)
    server.hold()
    watch = Stopwatch()
    ask(server, *first)
    # a request for the second may come later: a client may ask for one target after the other
    server.expect_alive('the server takes its time', Point(x=second[0], y=second[1]))
    expect_no_others(server)
    # let a client with a timeout give up, but send soon if it repeats its request
    while watch.wall_sec() < slow_sec and not server.holds_many():
        server.expect_nothing(made_of=is_elbow_up, hint=lambda each: why_other(server, each))
    held = [first, second, *publish_one_more(server, *second)]
    expect_alive_when_released(server, *first)
    expect_each_elbow_up(server, *held)
    _let_all_be_answered(server)
    server.stop()
    server.expect_alive('there is no server', Point(x=first[0], y=first[1]))
    server.start()
    _expect_answer(server, *third)
    _let_all_be_answered(server)  # also the target without server, if the client kept it
    expect_no_others(server)


def _let_all_be_answered(server: Server) -> None:
    """Wait until the client got all responses: it would wait for a lost one for ever."""
    server.wait_for_repeated()
    server.made.wait_for_rest(is_elbow_up, leads=lambda response: response.reachable)


def ask(server: Server, x: float, y: float) -> None:
    """Publish a target, and expect the client to request it. Raises CheckFailed."""
    server.ask(
        Point(x=x, y=y),
        is_it=lambda asked: is_for(asked, x, y),
        hint=AS_ARRIVED,
    )


def expect_no_answer(server: Server, x: float, y: float) -> None:
    """Expect the client to request a target out of reach, but publish nothing for it.

    Raises CheckFailed.
    """
    expect_no_others(server)
    asked_ns = time.time_ns()
    ask(server, x, y)

    def why_wrong(message: Any) -> str:
        if server.made.was_sent_before(asked_ns, message):
            return why_other(server, message)
        if any(is_elbow_up(message, response) for response in server.sent):
            return (
                'publish only if response.reachable is True, and each answer once, not in a timer'
            )
        return 'publish only if response.reachable is True'

    server.expect_nothing(made_of=is_elbow_up, hint=why_wrong)
