"""The two topics of a relay: connect to the student's node on both of them."""

from dataclasses import dataclass
from typing import Any, NoReturn

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)

from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.topics.topic_endpoints import ABSENT_SEC
from my_robot_basics.checks.topics.topics import Topic
from my_robot_basics.exchange import values
from my_robot_basics.feedback.errors import expect, fail
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import graphs
from my_robot_basics.graph.qos_compatibility import hint_to_omit, incompatible_policies, qos_text
from my_robot_basics.graph.snapshot import GraphSnapshot
from my_robot_basics.graph.stop_reasons import what_raised, what_stopped
from my_robot_basics.graph.watcher import Watcher

TIMEOUT_SEC = 10.0
REFUSED_SEC = 2.0
"""How long to wait for another subscription after an incompatible one (wall time)."""
SECOND_SEC = 0.1
"""How long to wait for a second subscription after the first one (wall time)."""


@dataclass(frozen=True)
class RelayEndpoints:
    """The topic that a relay subscribes to (`source`), and the one it publishes on (`to`)."""

    source: str
    to: str

    def listen(self, watcher: Watcher, type_: type) -> Recorder:
        """Subscribe to `to`; wait until matched, as a VOLATILE publisher keeps no messages."""
        recorder = Topic(self.to).listen(watcher, take=self._graph_without_publisher)
        expect(
            recorder.type is type_,
            expected=f'{type_.__name__} messages on {self.to}',
            seen=recorder.type.__name__,
            hint=f'publish there the messages that arrive on {self.source}',
        )
        watcher.spin_until(recorder.is_connected, timeout_sec=TIMEOUT_SEC)
        return recorder

    def publish_to_node(self, watcher: Watcher, type_: type, offered: QoSProfile) -> Publisher:
        """A publisher on `source`, once a compatible subscription matches. Raises CheckFailed."""
        refused = set()

        def refuse(event: Any) -> None:
            refused.add(event.last_policy_kind)

        events = PublisherEventCallbacks(incompatible_qos=refuse)
        publisher = watcher.node.create_publisher(
            type_, self.source, offered, event_callbacks=events
        )

        def is_there() -> bool:
            return publisher.get_subscription_count() > 0

        timeout_sec = self._timeout_sec(watcher, type_)
        watcher.spin_until(lambda: is_there() or bool(refused), timeout_sec=timeout_sec)
        if watcher.spin_until(is_there, timeout_sec=REFUSED_SEC if refused else 0.0):
            return publisher
        if not refused:
            self.expect_type(watcher, type_)
            self._fail_absent(watcher, timeout_sec=timeout_sec)
        asked = {qos_text(asked) for asked in _requests(watcher.node, self.source)}
        policies = {qos_policy_name_from_kind(kind) for kind in refused}
        hint = 'give create_subscription a profile with reliability and durability as offered'
        if unpromised := policies - {'RELIABILITY', 'DURABILITY'}:
            hint = hint_to_omit(unpromised)
        fail(
            expected=f'a subscription on {self.source} that requests no more than'
            f' {qos_text(offered)}, which is what the publisher offers',
            seen=f'{" and ".join(sorted(asked))} (incompatible: {" and ".join(sorted(policies))})',
            hint=hint,
        )

    def expect_transient_local(self, watcher: Watcher) -> None:
        """A subscription to `source` requests TRANSIENT_LOCAL. Raises CheckFailed.

        Call it when there is a publisher: a node may copy that publisher's QoS.
        """

        def asked() -> set[str]:
            return {asked.durability.name for asked in _requests(watcher.node, self.source)}

        timeout_sec = self._timeout_sec(watcher)
        if not watcher.spin_until(lambda: bool(asked()), timeout_sec=timeout_sec):
            self._fail_absent(watcher, timeout_sec=timeout_sec)
        # a second subscription may be discovered shortly after the first
        if not watcher.spin_until(lambda: 'TRANSIENT_LOCAL' in asked(), timeout_sec=SECOND_SEC):
            fail(
                expected=f'a subscription on {self.source} with durability TRANSIENT_LOCAL',
                seen=' and '.join(sorted(asked())),
                hint='request TRANSIENT_LOCAL: only then do you receive earlier messages',
            )

    def expect_one_profile(self, watcher: Watcher) -> None:
        """The node that publishes on `to` subscribes with one profile. Raises CheckFailed."""
        offers = graphs.publisher_infos(watcher.node, self.to)
        names = {graphs.full_name(offer) for offer in offers}
        asked = {
            qos_text(info.qos_profile)
            for info in graphs.subscription_infos(watcher.node, self.source)
            if graphs.full_name(info) in names
        }
        expect(
            len(asked) <= 1,
            expected=f'one subscription on {self.source}, with the profile that fits',
            seen=' and '.join(sorted(asked)),
            hint='choose one profile: with one subscription of each kind, some never receive'
            ' anything, and others receive everything twice',
        )

    def why_lost(self, watcher: Watcher, *, is_latched: bool, has_others: bool) -> str:
        """What to try if a message does not come out of the node: one clause."""
        asked = [
            asked
            for asked in _requests(watcher.node, self.source)
            if asked.durability == DurabilityPolicy.TRANSIENT_LOCAL
        ]
        if is_latched and {each.reliability for each in asked} == {ReliabilityPolicy.BEST_EFFORT}:
            return 'request RELIABLE, too: only then do you receive earlier messages'
        offers = watcher.node.get_publishers_info_by_topic(self.source)
        gaps = [incompatible_policies(info.qos_profile, each) for info in offers for each in asked]
        if is_latched and gaps and all(gaps):
            return hint_to_omit(gaps[0])
        listeners = graphs.subscription_infos(watcher.node, self.source)
        if why := what_stopped(map(graphs.full_name, listeners)):
            return f'{why}; fix that first'
        if has_others:
            return 'publish exactly the message that your callback is given'
        return (
            'see that your node spins (any second one, too), that your callback publishes each'
            ' message, and that it raises nothing'
        )

    def expect_type(self, watcher: Watcher, type_: type) -> None:
        """If `source` has subscriptions, one of them has that type. Raises CheckFailed."""
        wanted = values.type_name(type_)
        infos = graphs.subscription_infos(watcher.node, self.source)
        found = {info.topic_type for info in infos}
        expect(
            not found or wanted in found,
            expected=f'a subscription on {self.source} for {wanted}',
            seen=f'one for {" and ".join(sorted(found))}',
            hint='compare the message type in create_subscription(…)',
        )

    def _timeout_sec(self, watcher: Watcher, type_: type | None = None) -> float:
        """How long to wait for a subscription, once there is a publisher.

        At least ABSENT_SEC: before it subscribes, a node may look for publishers in a timer.
        """
        topic = Topic(self.source)
        timeout_sec = topic.timeout_for(watcher, TIMEOUT_SEC, end='subscriptions', type_=type_)
        return min(TIMEOUT_SEC, max(timeout_sec, ABSENT_SEC))

    def _fail_absent(self, watcher: Watcher, *, timeout_sec: float) -> NoReturn:
        fail(
            expected=f'a subscription on {self.source}',
            seen=graphs.none_in(timeout_sec),
            hint=self._graph(watcher).why_no_subscription(self.source),
        )

    def _graph_without_publisher(self, watcher: Watcher) -> GraphSnapshot:
        """The graph if `to` has no publisher. Raises CheckFailed if it shows the reason."""
        graph = self._graph(watcher)
        listeners = sorted({*graph.subscriptions(self.source)})
        if listeners and graph.publishes_nothing(listeners) and not what_raised(listeners):
            fail(
                expected=f'a publisher on {self.to}',
                seen='none',
                hint=f'{student_text(", ".join(listeners))} subscribes to {self.source} and has no'
                ' publisher yet, so create it in __init__: it has to be there before the first'
                ' message comes',
            )
        return graph

    def _graph(self, watcher: Watcher) -> GraphSnapshot:
        """The graph without other nodes that publish on `source`: the fault is not theirs."""
        everybody = graphs.take_snapshot(watcher)
        others = everybody.without(everybody.publishers(self.source))
        return others if others.nodes() else everybody


def _requests(node: Node, topic_name: str) -> list[QoSProfile]:
    """The QoS profiles that the student's subscriptions on a topic request."""
    return [info.qos_profile for info in graphs.subscription_infos(node, topic_name)]
