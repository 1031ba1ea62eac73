"""One more target for a client of `/solve_ik`, if it lets targets wait or seems to block."""

from geometry_msgs.msg import Point

from my_robot_basics.checks.services.elbow_up import is_elbow_up, why_other
from my_robot_basics.checks.services.servers import Server

TAKES_LONG = (
    'the function that gets the answer takes too long, and no callback runs meanwhile: let it '
    'only publish, without a sleep or a wait'
)


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


def expect_alive_when_released(server: Server, x: float, y: float) -> None:
    """Send the responses that were held back; the client continues to count when they arrive.

    It gets the target (x, y) again if they seem to block it. Raises CheckFailed, Starved.
    """

    def send() -> None:
        if server.holds_any():
            server.release()
        else:
            server.publish(Point(x=x, y=y), anew=False)

    server.expect_alive_during('answers arrive', send, hint=TAKES_LONG)
