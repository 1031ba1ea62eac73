"""Messages that are published before anybody subscribes, and kept for late joiners."""

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
"""How often to try to publish before discovery is done; most often the first time will do."""


@contextmanager
def published_before_discovery(
    topic_name: str, make_message: Callable[[], Any]
) -> Iterator[tuple[Any, Publisher]]:
    """Yield a message that was published when its publisher's participant knew of nobody.

    The participant stays, to be met. Where discovery was faster, all begins again: a node that had
    met the publisher before it spoke gets the message without having asked for it.
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
