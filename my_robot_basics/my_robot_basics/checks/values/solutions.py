"""A request to `/solve_ik`, and the right response to it."""

import math

from geometry_msgs.msg import Point

from arm_interfaces.srv import SolveIK
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import NotRunnable
from my_robot_basics.two_link_kinematics import L1, L2, inverse_kinematics

NEAR_M = 1e-6
"""How far the target of a request may be from the expected one."""


def request(x: float, y: float, *, z: float = 0.0) -> SolveIK.Request:
    """A request for a target, in metres."""
    return SolveIK.Request(target=Point(x=x, y=y, z=z))


def is_for(asked: SolveIK.Request, x: float, y: float) -> bool:
    """Whether a request is for that target, in metres."""
    return math.hypot(asked.target.x - x, asked.target.y - y) < NEAR_M


def solve(asked: SolveIK.Request, *, l1: float = L1, l2: float = L2) -> SolveIK.Response:
    """The right response to a request.

    With link lengths (in m) other than the course's, only a client of the check's server can know
    the angles. Students must not call this function: it raises NotRunnable in the student's room.
    """
    if classroom.in_students_room():
        raise NotRunnable(
            "expected a solution of your own, saw a call of the checks' `solve`: write it in the "
            'answer cell; the functions of two_link_kinematics may be called'
        )
    response = SolveIK.Response()
    try:
        branches_deg = inverse_kinematics(asked.target.x, asked.target.y, l1, l2)
    except ValueError as error:
        response.message = str(error)
        return response
    response.reachable = True
    response.elbow_up = [math.radians(angle) for angle in branches_deg['elbow_up']]
    response.elbow_down = [math.radians(angle) for angle in branches_deg['elbow_down']]
    return response
