"""What is received on a topic, and when it was sent."""

import itertools
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile

from my_robot_basics.graph import graphs
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.qos_compatibility import incompatible
from my_robot_basics.graph.watcher import Watcher

MOST_AT_ONCE = 10_000
"""A node that publishes on and on may be quicker than we are."""
_NO_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
"""Each look of an executor costs more for every event; nobody waits for these."""


TOLD = {'RELIABILITY', 'DURABILITY'}
"""What a profile says that names no more: what it leaves out is no request."""


class Recorder:
    """A subscription that keeps every message with the wall time at which it was sent."""

    def __init__(
        self, watcher: Watcher, *, topic_name: str, type_: type, qos_profile: QoSProfile
    ) -> None:
        self.topic_name = topic_name
        self.type = type_
        self.received: list[tuple[Any, int]] = []
        self._node = watcher.node
        self._qos_profile = qos_profile
        self._subscription = self._node.create_subscription(
            type_,
            topic_name,
            with_info(self._receive),
            qos_profile,
            event_callbacks=_NO_EVENTS,
        )
        self._publishers: tuple[str, ...] = ()

    def is_connected(self) -> bool:
        """Whether a publisher has been met, or those that are there offer too little to be met."""
        if self._subscription.get_publisher_count() > 0:
            return True
        infos = graphs.publisher_infos(self._node, self.topic_name)
        gaps = [incompatible(info.qos_profile, self._qos_profile) for info in infos]
        return bool(gaps) and all(TOLD & each.keys() for each in gaps)

    def publishers(self) -> tuple[str, ...]:
        """Full names of the nodes that publish on the topic, one for each publisher.

        The most that were ever seen: one may have gone when the recording ends.
        """
        infos = graphs.publisher_infos(self._node, self.topic_name)
        now = tuple(sorted(graphs.full_name(info) for info in infos))
        self._publishers = max(now, self._publishers, key=len)
        return self._publishers

    def endpoint_gids(self) -> set[tuple[int, ...]]:
        """The publishers that are there now, each as DDS knows it."""
        infos = graphs.publisher_infos(self._node, self.topic_name)
        return {tuple(info.endpoint_gid) for info in infos}

    def messages(self) -> list[Any]:
        """The messages received so far."""
        return [message for message, _ in self.received]

    def count_since(self, wall_ns: int) -> int:
        """How many messages were sent after that wall time: quick to tell, there may be many."""
        newest_first = reversed(self.received)
        return sum(1 for _ in itertools.takewhile(lambda each: each[1] > wall_ns, newest_first))

    def seconds_since(self, wall_ns: int) -> float:
        """How long after the first message that was sent after that wall time the last one was."""
        sent_ns = [sent_ns for _, sent_ns in self.received if sent_ns > wall_ns]
        return (sent_ns[-1] - sent_ns[0]) / 1e9 if sent_ns else 0.0

    def take_all(self) -> None:
        """Take all that has come by now: a look of the executor takes one message."""
        handle = self._subscription.handle
        with handle:
            for _ in range(MOST_AT_ONCE):
                taken = handle.take_message(self.type, False)
                if taken is None:
                    break
                self._receive(*taken)

    def close(self) -> None:
        """Receive no more."""
        self._node.destroy_subscription(self._subscription)

    def _receive(self, message: Any, info: dict) -> None:
        self.received.append((message, info['source_timestamp']))
