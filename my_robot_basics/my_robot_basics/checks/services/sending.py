"""Send responses reliably to clients that DDS has not discovered completely yet."""

import time
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.node import Node

ATTEMPTS = 50
"""How often to send a response; in each attempt, rmw waits 0.1 s for the client's endpoint."""
POLL_SEC = 0.01
_PARTICIPANT_BYTES = 12
"""The first bytes of an endpoint's GID, which identify its DDS participant."""


def send_until_met(send: Callable[[], None]) -> None:
    """Call `send` again while rclpy warns that the client will not receive the response.

    rclpy does so if the client is not discovered within 0.1 s, as happens on a busy machine.
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
    """Wait until DDS has discovered the response reader of each client of these services.

    An `ActionServer` sends a response once, and rmw drops it if the reader is unknown then. The
    service `asked` has received a request, so it has a client even if the graph shows none yet.
    Names are full, such as '/move_arm/_action/send_goal'. It waits 5 s at most.
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
