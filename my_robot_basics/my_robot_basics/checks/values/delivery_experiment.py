"""Run publishers and subscriptions of the check's own, to see which messages really arrive.

They are in two participants, as in two processes. A check never concludes from silence that a
message does not arrive. After each endpoint, it makes a control endpoint. DDS announces endpoints
in the order in which they are made: once the control endpoints have matched, the endpoints have
matched, too, or never will. And a mark that is published last arrives last.
"""

import re
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node
from std_msgs.msg import String

from my_robot_basics.graph.watcher import Watcher

DEPTH = 10
"""The queue depth in the lessons; the rest of the QoS profile is rclpy's default."""
TIMEOUT_SEC = 10.0


class DidNotRun(RuntimeError):
    """The check's own nodes did not discover each other in time, so there is no verdict."""


@contextmanager
def watchers() -> Iterator[tuple[Watcher, Watcher]]:
    """Two participants for stages; in the test's room, no student's process can reach them."""
    with Watcher(apart=True) as senders, Watcher(apart=True) as receivers:
        yield senders, receivers


class Stage:
    """The publishers and subscriptions of one situation, on topics with names of their own."""

    def __init__(self, senders: Watcher, receivers: Watcher) -> None:
        """Use the two participants of `watchers`, which other stages may have used before."""
        self._senders, self._receivers = senders, receivers
        self._token = uuid.uuid4().hex
        self._messages = 0
        self.control_topic = self._own('/control')
        self.publishers: list[StagePublisher] = []
        self.subscriptions: list[StageSubscription] = []

    def publisher(
        self, topic_name: str, *, namespace: str = '', remap: str = '', type_: type = String
    ) -> 'StagePublisher':
        """Make a publisher on a new node; `remap` is a rule like `pose:=/shown_pose`."""
        rule = ':='.join(self._own(name) for name in remap.split(':='))
        node = self._senders.add_node(
            'publisher', namespace=namespace, cli_args=['--ros-args', '-r', rule] if remap else ()
        )
        self.publishers.append(StagePublisher(self, node, self._own(topic_name), type_))
        return self.publishers[-1]

    def subscription(
        self, topic_name: str, *, namespace: str = '', type_: type = String
    ) -> 'StageSubscription':
        """Make a subscription on a new node."""
        node = self._receivers.add_node('subscription', namespace=namespace)
        self.subscriptions.append(StageSubscription(self, node, self._own(topic_name), type_))
        return self.subscriptions[-1]

    def message(self, type_: type) -> Any:
        """Make a message unlike all others of this stage; `type_` must have one field, data."""
        self._messages += 1
        return type_(data=type(type_().data)(self._messages))

    def settle(self) -> None:
        """Wait until all endpoints that can match have matched. Raises DidNotRun."""
        self.wait(
            lambda: (
                {end.control.get_subscription_count() for end in self.publishers}
                <= {len(self.subscriptions)}
                and {end.control.get_publisher_count() for end in self.subscriptions}
                <= {len(self.publishers)}
            )
        )

    def wait(self, done: Callable[[], bool]) -> None:
        """Receive messages until `done()`. Raises DidNotRun."""
        if not self._receivers.spin_until(done, timeout_sec=TIMEOUT_SEC):
            raise DidNotRun(
                'expected the nodes of this check to discover each other, saw that they did not in'
                f' {TIMEOUT_SEC:g} s: your answer is not the cause; run the cell again'
            )

    def _own(self, name: str) -> str:
        """The same name with a hidden last part that only this stage uses."""
        return re.sub(r'\w+$', lambda last: f'_{last[0]}_{self._token}', name)


class StagePublisher:
    """A publisher with default QoS."""

    def __init__(self, stage: Stage, node: Node, topic_name: str, type_: type) -> None:
        """Use `Stage.publisher`."""
        self._stage, self._type = stage, type_
        self._publisher = node.create_publisher(type_, topic_name, DEPTH)
        self.control = node.create_publisher(String, stage.control_topic, DEPTH)

    def publish(self) -> Any:
        """Publish a new message to the subscriptions that exist now, and return it."""
        self._stage.settle()
        message = self._stage.message(self._type)
        self._publisher.publish(message)
        return message

    def mark(self) -> tuple[Any, Any]:
        """Publish one last message on the topic, then one on the control topic; return both."""
        last, control = self.publish(), self._stage.message(String)
        self.control.publish(control)
        return last, control


class StageSubscription:
    """A subscription with default QoS, which keeps what it receives."""

    def __init__(self, stage: Stage, node: Node, topic_name: str, type_: type) -> None:
        """Use `Stage.subscription`."""
        self._stage, self._node = stage, node
        self._received: list[Any] = []
        self._controls: list[Any] = []
        self._subscription = node.create_subscription(
            type_, topic_name, self._received.append, DEPTH
        )
        self.control = node.create_subscription(
            String, stage.control_topic, self._controls.append, DEPTH
        )

    def received(self, *messages: Any) -> bool:
        """Whether all these messages arrived, after waiting for all that are on their way."""
        self._stage.settle()
        marks = [publisher.mark() for publisher in self._stage.publishers]
        matches = self._subscription.get_publisher_count()
        self._stage.wait(
            lambda: (
                all(control in self._controls for _, control in marks)
                and sum(last in self._received for last, _ in marks) == matches
            )
        )
        return all(message in self._received for message in messages)

    def close(self) -> None:
        """Destroy the subscription."""
        self._stage.subscriptions.remove(self)
        for subscription in self._subscription, self.control:
            self._node.destroy_subscription(subscription)
