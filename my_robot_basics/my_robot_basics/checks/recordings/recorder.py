"""A subscription that keeps the messages of a topic, and when each was sent."""

import itertools
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile

from my_robot_basics.graph import graphs
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.qos_compatibility import incompatible_policies
from my_robot_basics.graph.watcher import Watcher

MOST_AT_ONCE = 10_000
"""The most messages of one `take_all`: a node may publish faster than the check takes messages."""
_NO_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
"""QoS events are off: each one makes every wait of the executor slower, and no check uses them."""


TOLD = {'RELIABILITY', 'DURABILITY'}
"""The policies of a recorder's profile: only gaps in these mean that it will never connect."""


class Recorder:
    """A subscription that keeps every message with the wall time at which it was sent."""

    def __init__(
        self, watcher: Watcher, *, topic_name: str, type_: type, qos_profile: QoSProfile
    ) -> None:
        self.topic_name = topic_name
        self.type = type_
        self.received: list[tuple[Any, int]] = []
        self.offsets_ns: list[int] = []
        """How long after its time of sending each of them arrived."""
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
        """Whether a publisher is matched, or all publishers offer too little to be matched."""
        if self._subscription.get_publisher_count() > 0:
            return True
        infos = graphs.publisher_infos(self._node, self.topic_name)
        gaps = [incompatible_policies(info.qos_profile, self._qos_profile) for info in infos]
        return bool(gaps) and all(TOLD & each.keys() for each in gaps)

    def publishers(self) -> tuple[str, ...]:
        """Full names of the nodes that publish on the topic, one for each publisher.

        It is the largest list seen so far: a node may have ended before the recording does.
        """
        infos = graphs.publisher_infos(self._node, self.topic_name)
        now = tuple(sorted(graphs.full_name(info) for info in infos))
        self._publishers = max(now, self._publishers, key=len)
        return self._publishers

    def hidden_publishers(self) -> tuple[str, ...]:
        """The same for nodes whose names start with `_`: what they send is recorded, too."""
        infos = self._node.get_publishers_info_by_topic(self.topic_name)
        return tuple(sorted(graphs.full_name(info) for info in infos if graphs.is_hidden(info)))

    def has_other_publishers(self, other: 'Recorder') -> bool:
        """Whether nodes publish on this topic that do not publish on that of the other one."""
        return bool(set(self.publishers()) - set(other.publishers()))

    def endpoint_gids(self) -> set[tuple[int, ...]]:
        """The DDS endpoint GIDs of the publishers that exist now."""
        infos = graphs.publisher_infos(self._node, self.topic_name)
        return {tuple(info.endpoint_gid) for info in infos}

    def messages(self) -> list[Any]:
        """The messages received so far."""
        return [message for message, _ in self.received]

    def count_since(self, wall_ns: int) -> int:
        """How many messages were sent after that wall time; fast even if there are many."""
        newest_first = reversed(self.received)
        return sum(1 for _ in itertools.takewhile(lambda each: each[1] > wall_ns, newest_first))

    def seconds_since(self, wall_ns: int) -> float:
        """Seconds from the first to the last message of those sent after that wall time."""
        sent_ns = [sent_ns for _, sent_ns in self.received if sent_ns > wall_ns]
        return (sent_ns[-1] - sent_ns[0]) / 1e9 if sent_ns else 0.0

    def take_all(self) -> None:
        """Take all messages that have arrived; the executor takes one of them per spin."""
        handle = self._subscription.handle
        with handle:
            for _ in range(MOST_AT_ONCE):
                taken = handle.take_message(self.type, False)
                if taken is None:
                    break
                self._receive(*taken)

    def close(self) -> None:
        """Destroy the subscription."""
        self._node.destroy_subscription(self._subscription)

    def _receive(self, message: Any, info: dict) -> None:
        sent_ns = info['source_timestamp']
        self.received.append((message, sent_ns))
        self.offsets_ns.append(info['received_timestamp'] - sent_ns)
