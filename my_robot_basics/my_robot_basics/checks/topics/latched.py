"""Messages that are published before discovery, and kept for late-joining subscribers."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from my_robot_basics.graph.watcher import Watcher

LATCHED = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
MOST_PARTICIPANTS = 100
"""How often to try to publish before discovery is done; mostly, the first try succeeds."""


@contextmanager
def published_before_discovery(
    topic_name: str, make_message: Callable[[], Any]
) -> Iterator[tuple[Any, Publisher]]:
    """Yield a message, and its publisher, which published it before it discovered a subscription.

    The participant stays for subscribers to discover. If discovery was faster than the message,
    try again with a new participant: a node that had already matched the publisher would receive
    the message even without TRANSIENT_LOCAL.
    """
    for _ in range(MOST_PARTICIPANTS):
        with Watcher() as stranger:
            message = make_message()
            publisher = stranger.node.create_publisher(type(message), topic_name, LATCHED)
            publisher.publish(message)
            if publisher.get_subscription_count() == 0:
                yield message, publisher
                return
    raise RuntimeError(f'discovery was faster than a first message, {MOST_PARTICIPANTS} times')
