"""Whether a server responds with the angles that it filled in for the request before."""

import math

from my_robot_basics.checks.services.services import Service
from my_robot_basics.checks.values.solutions import request, solve

BEFORE = (0.7, 0.9), (-1.1, 0.4)
"""Two targets within reach, in metres: a server might always respond with the angles of one."""
NEAR_RAD = 1e-3


def why_left_over(service: Service, x: float, y: float) -> str:
    """Advice if a target out of reach gets the angles of the target before; else ''.

    Raises CheckFailed if the service does not answer.
    """
    for before in BEFORE:
        service.call(request(*before))
        seen = service.call(request(x, y)).elbow_up[:3]
        right = solve(request(*before)).elbow_up
        if not (len(seen) == len(right) and math.dist(seen, right) < NEAR_RAD):
            return ''
    return (
        'these are the angles of the request before it: fill in the response that your callback '
        'is given, which is empty each time, and keep none'
    )
