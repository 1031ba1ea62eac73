"""Measure which QoS profiles are compatible, with a topic of its own for each pair."""

from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_policy_name_from_kind
from std_msgs.msg import Int32

from my_robot_basics.live.output.waiting import wait_until
from my_robot_basics.session import classroom

TIMEOUT_SEC = 10.0


def measure_pairs(profiles: Mapping[str, QoSProfile]) -> dict[tuple[str, str], str]:
    """Send a message from each profile to each profile; return the outcome of each pair.

    The keys are pairs of names, (offered, requested). The outcome is 'yes' if the message
    arrived, else the name of the incompatible policy. Raises WaitTimeout if a pair has neither
    outcome in time.
    """
    classroom.enter()
    context = Context()
    context.init([], initialize_logging=False)
    try:
        return _Pairs(profiles, context=context).measure()
    finally:
        context.try_shutdown()


class _Pairs(Node):
    """A publisher and a subscription for each pair of profiles."""

    def __init__(self, profiles: Mapping[str, QoSProfile], *, context: Context) -> None:
        super().__init__(
            '_pairs',
            context=context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._outcome: dict[tuple[str, str], str] = {}
        self._senders: dict[tuple[str, str], Publisher] = {}
        self._executor = SingleThreadedExecutor(context=context)
        for offered, asked in product(profiles, repeat=2):
            self._connect((offered, asked), profiles[offered], profiles[asked])

    def measure(self) -> dict[tuple[str, str], str]:
        """Send a message on each topic, return the outcomes, and destroy the node."""
        self._executor.add_node(self)
        senders = self._senders.items()
        try:
            self._spin_until(
                lambda: all(s.get_subscription_count() or p in self._outcome for p, s in senders)
            )
            for sender in self._senders.values():
                sender.publish(Int32())
            self._spin_until(lambda: len(self._outcome) == len(senders))
        finally:
            self._executor.shutdown()
            self.destroy_node()
        return {pair: self._outcome[pair] for pair in self._senders}

    def _connect(self, pair: tuple[str, str], offered: QoSProfile, asked: QoSProfile) -> None:
        def receive(message: Int32) -> None:
            self._outcome[pair] = 'yes'

        def refuse(event: Any) -> None:
            self._outcome[pair] = qos_policy_name_from_kind(event.last_policy_kind)

        topic_name = f'/_pair_{len(self._senders)}'
        quiet = PublisherEventCallbacks(use_default_callbacks=False)
        events = SubscriptionEventCallbacks(incompatible_qos=refuse)
        self._senders[pair] = self.create_publisher(
            Int32, topic_name, offered, event_callbacks=quiet
        )
        self.create_subscription(Int32, topic_name, receive, asked, event_callbacks=events)

    def _spin_until(self, condition: Callable[[], bool]) -> None:
        def is_so() -> bool:
            self._executor.spin_once(timeout_sec=0.0)
            return condition()

        wait_until(is_so, TIMEOUT_SEC)
