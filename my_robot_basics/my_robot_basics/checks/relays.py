"""A node that republishes what it receives: send on one topic, subscribe to the other."""

from collections.abc import Callable
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

from my_robot_basics.checks import graphs, values
from my_robot_basics.checks.carried import QUIET_SEC, Carried, carry
from my_robot_basics.checks.errors import expect, fail
from my_robot_basics.checks.fits import brief, incompatible, leave_out
from my_robot_basics.checks.latched import said_to_nobody
from my_robot_basics.checks.looks import Ears
from my_robot_basics.checks.topics import Topic
from my_robot_basics.checks.watcher import Watcher

TIMEOUT_SEC = 10.0
TIMES = 10
"""Messages in a row: one that is left out now and then is among them."""
ATTEMPTS = 2
AGAIN_SEC = 0.1
"""How long to wait for a message to come out before it is sent once more."""
REFUSED_SEC = 2.0
"""How long another subscription of the node may come after one that asks for too much."""


def relay(source: str, *, to: str) -> 'Relay':
    """What a node makes of the topic `source` when it publishes again on the topic `to`."""
    return Relay(source, to)


@dataclass(frozen=True)
class Relay:
    """Two topics with a node of the student between them; any QoS will do on the second one."""

    source: str
    to: str

    def assert_carries(
        self, make_message: Callable[[], Any], *, qos_profile: QoSProfile, times: int = TIMES
    ) -> None:
        """Each of so many messages, offered with that profile on `source`, comes out on `to`.

        `make_message` makes each another one. They are sent one at a time: each has to come out
        before the next one, and once. The first is sent again and again meanwhile, and where one
        of the others is amiss, all begins anew: a BEST_EFFORT end may lose one.
        """
        with Watcher() as watcher:
            first = make_message()
            ears = self._listen(watcher, type(first))
            publisher = self._publish_to_node(watcher, type(first), qos_profile)
            self._expect_one_profile(watcher)
            self._expect_out(watcher, ears, first, again=publisher)
            for _ in range(ATTEMPTS):
                messages = [make_message() for _ in range(times)]
                carried = carry(watcher, ears, messages, publish=publisher.publish, is_same=_says)
                if carried.is_whole():
                    return
            self._fail_carried(carried)

    def assert_carries_latched(self, make_message: Callable[[], Any], *, times: int = 1) -> None:
        """A message that was published before anybody subscribed comes out on `to`, once.

        So many times a new participant publishes one latched message, a new one of
        `make_message`, before it has met anybody. And the graph says that the node asks for it:
        TRANSIENT_LOCAL.
        """
        with Watcher() as watcher:
            ears = self._listen(watcher, type(make_message()))
            self._expect_transient_local(watcher)
            self._expect_type(watcher, ears.type)
            self._expect_one_profile(watcher)
            for _ in range(times):
                with said_to_nobody(self.source, make_message) as (message, _):
                    self._expect_out(watcher, ears, message)
                    # one behind the other, should there be two
                    watcher.spin_for(QUIET_SEC)
                count = sum(_says(heard, message) for heard in ears.messages())
                if count > 1:
                    self._fail_carried(Carried(counts=(count,), late=0))

    def _listen(self, watcher: Watcher, type_: type) -> Ears:
        """Listen on `to`; a VOLATILE publisher is waited for until it knows of the listener."""
        topic = Topic(self.to)
        patience_sec = topic.patience_sec(watcher, TIMEOUT_SEC, end='publishers')
        if not graphs.wait_for_publisher(watcher, self.to, timeout_sec=patience_sec):
            fail(
                expected=f'a publisher on {self.to}',
                seen=graphs.none_in(patience_sec),
                hint=self._graph(watcher).why_silent(self.to),
            )
        ears = topic.listen(watcher)
        expect(
            ears.type is type_,
            expected=f'{type_.__name__} messages on {self.to}',
            seen=ears.type.__name__,
            hint=f'publish there the messages that arrive on {self.source}',
        )
        watcher.spin_until(ears.is_connected, timeout_sec=TIMEOUT_SEC)
        return ears

    def _publish_to_node(self, watcher: Watcher, type_: type, offered: QoSProfile) -> Publisher:
        """A publisher that has met a subscription which asks for no more than it offers."""
        refused = set()
        events = PublisherEventCallbacks(
            incompatible_qos=lambda event: refused.add(event.last_policy_kind)
        )
        publisher = watcher.node.create_publisher(
            type_, self.source, offered, event_callbacks=events
        )

        def is_there() -> bool:
            return publisher.get_subscription_count() > 0

        patience_sec = Topic(self.source).patience_sec(
            watcher, TIMEOUT_SEC, end='subscriptions', type_=type_
        )
        watcher.spin_until(lambda: is_there() or bool(refused), timeout_sec=patience_sec)
        if watcher.spin_until(is_there, timeout_sec=REFUSED_SEC if refused else 0.0):
            return publisher
        if not refused:
            self._expect_type(watcher, type_)
            self._fail_absent(watcher, patience_sec=patience_sec)
        asked = {brief(asked) for asked in _requests(watcher.node, self.source)}
        policies = {qos_policy_name_from_kind(kind) for kind in refused}
        hint = 'give create_subscription a profile with reliability and durability as offered'
        if unpromised := policies - {'RELIABILITY', 'DURABILITY'}:
            hint = leave_out(unpromised)
        fail(
            expected=f'a subscription on {self.source} that requests no more than'
            f' {brief(offered)}, which is what the publisher offers',
            seen=f'{" and ".join(sorted(asked))} (incompatible: {" and ".join(sorted(policies))})',
            hint=hint,
        )

    def _expect_transient_local(self, watcher: Watcher) -> None:
        def asked() -> set[str]:
            return {asked.durability.name for asked in _requests(watcher.node, self.source)}

        patience_sec = Topic(self.source).patience_sec(watcher, TIMEOUT_SEC, end='subscriptions')
        if not watcher.spin_until(lambda: bool(asked()), timeout_sec=patience_sec):
            self._fail_absent(watcher, patience_sec=patience_sec)
        # a second subscription may be a moment behind the first
        if not watcher.spin_until(lambda: 'TRANSIENT_LOCAL' in asked(), timeout_sec=AGAIN_SEC):
            fail(
                expected=f'a subscription on {self.source} with durability TRANSIENT_LOCAL',
                seen=' and '.join(sorted(asked())),
                hint='request TRANSIENT_LOCAL: only then do you receive earlier messages',
            )

    def _expect_one_profile(self, watcher: Watcher) -> None:
        """The node that publishes on `to` subscribes to `source` with one profile: it chose."""
        offers = graphs.publisher_infos(watcher.node, self.to)
        names = {graphs.full_name(offer) for offer in offers}
        asked = {
            brief(info.qos_profile)
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

    def _fail_carried(self, carried: Carried) -> NoReturn:
        seen, hint = carried.fault()
        fail(
            expected=f'each message on {self.source} to be republished on {self.to} once, at once',
            seen=seen,
            hint=hint,
            cause=seen,
        )

    def _expect_out(
        self, watcher: Watcher, ears: Ears, message: Any, *, again: Publisher | None = None
    ) -> None:
        """Wait for the message on `to`; publish it `again` and again meanwhile."""
        before = len(ears.messages())
        for _ in range(round(TIMEOUT_SEC / AGAIN_SEC)):
            if again is not None:
                again.publish(message)
            if watcher.spin_until(
                lambda: any(_says(heard, message) for heard in ears.messages()),
                timeout_sec=AGAIN_SEC,
            ):
                return
        has_others = len(ears.messages()) > before
        fail(
            expected=f'a message from {self.source} to be republished on {self.to}, unchanged',
            seen=f'{"only others" if has_others else "none"} in {TIMEOUT_SEC:g} s',
            hint=self._why_lost(watcher, is_latched=again is None, has_others=has_others),
            cause=f'{"only other messages arrive" if has_others else "no message arrives"} on'
            f' {self.to}',
        )

    def _why_lost(self, watcher: Watcher, *, is_latched: bool, has_others: bool) -> str:
        asked = [
            asked
            for asked in _requests(watcher.node, self.source)
            if asked.durability == DurabilityPolicy.TRANSIENT_LOCAL
        ]
        if is_latched and {each.reliability for each in asked} == {ReliabilityPolicy.BEST_EFFORT}:
            return 'request RELIABLE, too: only then do you receive earlier messages'
        offers = watcher.node.get_publishers_info_by_topic(self.source)
        gaps = [incompatible(offer.qos_profile, each) for offer in offers for each in asked]
        if is_latched and gaps and all(gaps):
            return leave_out(gaps[0])
        listeners = graphs.subscription_infos(watcher.node, self.source)
        if raised := graphs.what_raised(map(graphs.full_name, listeners)):
            return f'{raised}, so fix that first'
        if has_others:
            return 'publish exactly the message that your callback is given'
        return 'see that your callback publishes each message, and that it raises nothing'

    def _expect_type(self, watcher: Watcher, type_: type) -> None:
        """Who subscribes to `source` does so with that type: another one never meets it."""
        wanted = values.type_name(type_)
        infos = graphs.subscription_infos(watcher.node, self.source)
        found = {info.topic_type for info in infos}
        expect(
            not found or wanted in found,
            expected=f'a subscription on {self.source} for {wanted}',
            seen=f'one for {" and ".join(sorted(found))}',
            hint='compare the message type in create_subscription(…)',
        )

    def _fail_absent(self, watcher: Watcher, *, patience_sec: float) -> NoReturn:
        fail(
            expected=f'a subscription on {self.source}',
            seen=graphs.none_in(patience_sec),
            hint=self._graph(watcher).why_unheard(self.source),
        )

    def _graph(self, watcher: Watcher) -> graphs.Graph:
        """The graph without other publishers on `source`: it is not they who are at fault."""
        everybody = graphs.take(watcher)
        others = everybody.without(everybody.publishers(self.source))
        return others if others.nodes() else everybody


def _requests(node: Node, topic_name: str) -> list[QoSProfile]:
    """What the student's subscriptions on a topic ask for."""
    return [info.qos_profile for info in graphs.subscription_infos(node, topic_name)]


def _says(heard: Any, sent: Any) -> bool:
    """Whether a message has all that was filled in in the other; its stamp may be a new one."""
    blank = type(sent)()
    return all(
        getattr(heard, field) == getattr(sent, field)
        for field in sent.get_fields_and_field_types()
        if getattr(sent, field) != getattr(blank, field)
    )
