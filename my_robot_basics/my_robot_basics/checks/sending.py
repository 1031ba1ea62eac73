"""Send a response also to a client that DDS has not met yet."""

import warnings
from collections.abc import Callable

ATTEMPTS = 50
"""Each waits 0.1 s for the client's end, as rmw does."""


def send_until_met(send: Callable[[], None]) -> None:
    """Call `send` again while rclpy warns that the client will not receive the response.

    It was not met in time: on a busy machine that takes longer, and the response is lost.
    """
    for _ in range(ATTEMPTS):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter('always')
            send()
        is_lost = False
        for each in said:
            if str(each.message).startswith('failed to send response (timeout)'):
                is_lost = True
            else:
                warnings.showwarning(each.message, each.category, each.filename, each.lineno)
        if not is_lost:
            return
