"""One more target for a client of `/solve_ik` that lets targets wait: it has to keep them all."""

from geometry_msgs.msg import Point

from my_robot_basics.checks.elbow_up import is_elbow_up, why_other
from my_robot_basics.checks.servers import Server


def publish_one_more(server: Server, x: float, y: float) -> list[tuple[float, float]]:
    """Publish one more target if the client has not asked for (x, y) yet; return it, or none.

    The server holds its responses back meanwhile. A client that asks for one target after the
    other may keep only the latest of those that wait. A client that asks at once gets no more:
    each call that waits may occupy one of its threads. Raises CheckFailed.
    """
    server.wait_for_repeated()
    if not server.holds_one():
        return []
    server.publish(Point(x=-x, y=-y))  # as far away, so within reach, too
    server.expect_nothing(made_of=is_elbow_up, hint=lambda each: why_other(server, each))
    return [(-x, -y)]
