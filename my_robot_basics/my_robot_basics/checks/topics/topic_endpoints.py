"""The endpoints of a topic: connect to the notebook's subscription or to its publisher."""

from collections.abc import Callable

from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.exchange import student, values
from my_robot_basics.feedback.errors import fail
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import graphs
from my_robot_basics.graph.snapshot import GraphSnapshot
from my_robot_basics.graph.watcher import Watcher

PUBLISHER_SEC = 10.0
ABSENT_SEC = 3.0
"""How long to wait for an endpoint that the notebook's process reports not to have."""
DEPTH = 5000
"""The queue of a recording, longer than any recording needs: KEEP_LAST drops the oldest."""
DISCOVERY_SEC = 0.5
"""The time for a BEST_EFFORT subscription to discover a publisher, or to receive its messages."""


class TopicEndpoints:
    """One topic, and the endpoints that a check creates on it."""

    def __init__(self, name: str) -> None:
        """Keep the topic's name; no endpoint is created yet."""
        self.name = name

    def meet(
        self, watcher: Watcher, type_: type, *, depth: int = 10, timeout_sec: float = 10.0
    ) -> Publisher:
        """A publisher compatible with every subscription, once one matches. Raises CheckFailed."""
        offer = QoSProfile(
            depth=max(10, depth),
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        publisher = watcher.node.create_publisher(type_, self.name, offer)
        timeout_sec = self.timeout_for(watcher, timeout_sec, end='subscriptions', type_=type_)
        if not watcher.spin_until(
            lambda: publisher.get_subscription_count() > 0, timeout_sec=timeout_sec
        ):
            self._fail_no_subscription(watcher, type_, timeout_sec=timeout_sec)
        # a BEST_EFFORT subscription may not know the publisher yet, and would lose messages
        watcher.spin_for(DISCOVERY_SEC if self.sends_once(watcher) else 0.0)
        return publisher

    def sends_once(self, watcher: Watcher) -> bool:
        """Whether a subscription is BEST_EFFORT: lost messages are not sent to it again."""
        infos = graphs.subscription_infos(watcher.node, self.name)
        return any(info.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT for info in infos)

    def listen(
        self,
        watcher: Watcher,
        *,
        type_: type | None = None,
        take: Callable[[Watcher], GraphSnapshot] = graphs.take_snapshot,
    ) -> Recorder:
        """Subscribe with the publishers' own type and QoS; wait for them first.

        `take` returns the graph that explains a missing publisher. Raises CheckFailed if there is
        no publisher, if publishers have different types, or if the type is not `type_`.
        """
        timeout_sec = self.timeout_for(watcher, PUBLISHER_SEC, end='publishers')
        if not graphs.wait_for_publisher(watcher, self.name, timeout_sec=timeout_sec):
            fail(
                expected=f'a publisher on {self.name}',
                seen=graphs.none_in(timeout_sec),
                hint=take(watcher).why_no_message(self.name),
            )
        message_type = self._message_type(watcher)
        if type_ is not None and message_type is not type_:
            fail(
                expected=f'{type_.__name__} messages on {self.name}',
                seen=message_type.__name__,
                hint='compare the message type in create_publisher(…)',
                cause=f'the messages on {self.name} have another type',
            )
        offers = graphs.publisher_infos(watcher.node, self.name)
        reliable = all(
            offer.qos_profile.reliability == ReliabilityPolicy.RELIABLE for offer in offers
        )
        wanted = QoSProfile(
            depth=DEPTH,
            reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        )
        return Recorder(watcher, topic_name=self.name, type_=message_type, qos_profile=wanted)

    def timeout_for(
        self, watcher: Watcher, most_sec: float, *, end: str, type_: type | None = None
    ) -> float:
        """How long to wait for an endpoint of the notebook: less if the notebook reports none.

        `end` is 'publishers' or 'subscriptions'; with `type_`, only endpoints of that type count.
        """
        type_name = values.type_name(type_) if type_ else ''
        infos = graphs.publisher_infos if end == 'publishers' else graphs.subscription_infos
        seen = {info.topic_type for info in infos(watcher.node, self.name)}
        is_seen = type_name in seen if type_name else bool(seen)
        if is_seen or student.has_endpoint(self.name, end, type_name):
            return most_sec
        if graphs.is_settled(watcher):
            return graphs.SETTLED_SEC
        return most_sec if student.has_endpoint(self.name) else min(most_sec, ABSENT_SEC)

    def _message_type(self, watcher: Watcher) -> type:
        """The message type of all publishers of the topic. Raises CheckFailed if they differ."""
        infos = graphs.publisher_infos(watcher.node, self.name)
        types = sorted({info.topic_type for info in infos})
        try:
            (name,) = types
            return values.message_type(name)
        except ValueError:
            fail(
                expected=f'one standard message type on {self.name}',
                seen=' and '.join(types),
                hint='create every publisher of a topic with the same type of common_interfaces',
            )

    def fail_silent(self, watcher: Watcher, *, seen: str) -> None:
        """Raise CheckFailed with the reason why no message comes."""
        if graphs.publisher_infos(watcher.node, self.name):
            # a publisher of another type may have been discovered only now
            self._message_type(watcher)
        hint = graphs.take_snapshot(watcher).why_no_message(self.name)
        fail(expected=f'messages on {self.name}', seen=seen, hint=hint)

    def _fail_no_subscription(self, watcher: Watcher, type_: type, *, timeout_sec: float) -> None:
        hint = graphs.take_snapshot(watcher).why_no_subscription(self.name)
        if infos := graphs.subscription_infos(watcher.node, self.name):
            type_name = student_text(infos[0].topic_type)
            hint = f'one is there for {type_name}, so compare the message type'
        seen = graphs.none_in(timeout_sec)
        fail(expected=f'a subscription on {self.name} for {type_.__name__}', seen=seen, hint=hint)
