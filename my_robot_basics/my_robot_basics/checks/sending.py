"""Send a response also to a client that DDS has not met yet."""

import time
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.node import Node

ATTEMPTS = 50
"""Each waits 0.1 s for the client's end, as rmw does."""
POLL_SEC = 0.01
_PARTICIPANT_BYTES = 12
"""So much of an endpoint's GID is its DDS participant's."""


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


def wait_for_readers(node: Node, services: Sequence[str], *, asked: str = '') -> None:
    """Wait until DDS knows where each client of these services reads its responses.

    An `ActionServer` sends a response once, and rmw drops it where it does not know that by then.
    A request of `asked` is there: so it has a client, although the graph may not know it yet.
    It waits as long as `send_until_met` does, at most. Full names: '/move_arm/_action/send_goal'.
    """
    for _ in range(round(ATTEMPTS * 0.1 / POLL_SEC)):
        if all(_knows_readers(node, name, is_asked=name == asked) for name in services):
            return
        time.sleep(POLL_SEC)


def _knows_readers(node: Node, service: str, *, is_asked: bool) -> bool:
    clients = node.get_publishers_info_by_topic(f'rq{service}Request', no_mangle=True)
    readers = node.get_subscriptions_info_by_topic(f'rr{service}Reply', no_mangle=True)
    if is_asked and not clients:
        return False
    return _participants(clients) <= _participants(readers)


def _participants(infos: Sequence[Any]) -> Counter[bytes]:
    return Counter(bytes(info.endpoint_gid[:_PARTICIPANT_BYTES]) for info in infos)
