"""The ROS graph at one moment, and what it shows about a topic on which nothing arrives."""

import difflib
from collections.abc import Collection
from dataclasses import dataclass

from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph.not_running import why_not_running
from my_robot_basics.graph.stop_reasons import what_stopped

PLUMBING = ('/clock', '/parameter_events', '/rosout')
"""Topics that rclpy itself uses in every node, whatever the node's author wrote."""


@dataclass(frozen=True)
class GraphSnapshot:
    """The nodes and endpoints of the graph, without nodes whose names start with `_`."""

    node_names: tuple[str, ...]
    """Full names, such as `/kinematics_publisher`, sorted."""
    publisher_names: dict[str, tuple[str, ...]]
    """Topic name to the full names of the nodes that publish there, one for each publisher."""
    subscription_names: dict[str, tuple[str, ...]]
    """Topic name to the full names of the nodes that subscribe there."""

    def nodes(self) -> tuple[str, ...]:
        """Full names of the nodes, sorted."""
        return self.node_names

    def publishers(self, topic_name: str) -> tuple[str, ...]:
        """Full names of the nodes that publish on the topic, one for each publisher."""
        return self.publisher_names.get(topic_name, ())

    def subscriptions(self, topic_name: str) -> tuple[str, ...]:
        """Full names of the nodes that subscribe to the topic, one for each subscription."""
        return self.subscription_names.get(topic_name, ())

    def publishes_nothing(self, node_names: Collection[str]) -> bool:
        """Whether none of those nodes has a publisher, apart from those on PLUMBING."""
        return not any(
            {*nodes} & {*node_names}
            for topic_name, nodes in self.publisher_names.items()
            if topic_name not in PLUMBING
        )

    def without(self, node_names: Collection[str]) -> 'GraphSnapshot':
        """The same graph without those nodes."""

        def left(names: dict[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
            rest = {
                topic_name: tuple(node for node in nodes if node not in node_names)
                for topic_name, nodes in names.items()
            }
            return {topic_name: nodes for topic_name, nodes in rest.items() if nodes}

        return GraphSnapshot(
            node_names=tuple(name for name in self.node_names if name not in node_names),
            publisher_names=left(self.publisher_names),
            subscription_names=left(self.subscription_names),
        )

    def why_no_message(self, topic_name: str) -> str:
        """What to try when nothing arrives on a topic: one clause."""
        if senders := self.publishers(topic_name):
            who = student_text(', '.join(dict.fromkeys(senders)))
            if why := what_stopped(senders):
                return f'{who} has a publisher there and sends nothing, because {why}'
            if self._has_subscription(senders):
                return (
                    f'{who} has a publisher there and sends nothing, so see that it spins, that '
                    'the callback of its subscription, or of its timer, calls publish(…), and that'
                    ' no callback raises (an `except` may hide that), or waits and so keeps the '
                    'node busy'
                )
            return (
                f'{who} has a publisher there and sends nothing, so see that it spins, that its '
                'timer is created (with a period in seconds, and the name of a method, without '
                'parentheses), that this method calls publish(…), and that no callback raises (an '
                '`except` may hide that), or waits and so keeps the node busy'
            )
        others = self.subscriptions(topic_name)
        return self._why_none(topic_name, self.publisher_names, 'create_publisher', others)

    def _has_subscription(self, node_names: Collection[str]) -> bool:
        return any(
            {*nodes} & {*node_names}
            for topic_name, nodes in self.subscription_names.items()
            if topic_name not in PLUMBING
        )

    def why_no_subscription(self, topic_name: str) -> str:
        """What to try when a topic has no subscription: one clause."""
        others = self.publishers(topic_name)
        return self._why_none(topic_name, self.subscription_names, 'create_subscription', others)

    def _why_none(
        self,
        topic_name: str,
        names: dict[str, tuple[str, ...]],
        maker: str,
        others: tuple[str, ...],
    ) -> str:
        # a node at the other end of the topic is usually not the one that is missing at this end
        runs = [name for name in self.node_names if name not in others]
        near = similar(topic_name, [name for name in names if name not in PLUMBING])
        # but it may be, if its publisher and its subscription are swapped
        if mixed := sorted({*names.get(near or '', others if not runs else ())} & {*others}):
            return (
                f'{student_text(", ".join(mixed))} is at the other end of this topic, so check the'
                f' name in {maker}(…); if another node is missing, run the cell that starts it'
            )
        if not runs:
            return why_not_running()
        if near:
            uses = student_text(f'{", ".join(names[near])} uses {near}')
            if near in {name.rpartition('/')[0] + topic_name for name in names[near]}:
                return f"{uses}: a name without a leading / is relative to its node's namespace"
            if near in {name + topic_name for name in names[near]}:
                return f"{uses}: a name with ~ begins with its node's own name"
            return f'{uses}, so compare the spelling'
        if why := what_stopped(runs):
            return f'{student_text(", ".join(runs))} runs, and {why}; fix that first'
        look = f'look at the topic name in {maker}(…) and that the node calls it'
        if len(runs) == 1:
            return f'{student_text(runs[0])} runs, so {look}'
        return (
            f'{student_text(", ".join(runs))} run, so if yours is among them, {look}; if it is'
            ' not, run the cell that starts it and read what it says'
        )


def similar(topic_name: str, others: list[str]) -> str | None:
    """The one of `others` that was probably meant by this name, or None."""
    last = topic_name.rpartition('/')[2]
    same_end = [name for name in others if name.rpartition('/')[2].lower() == last.lower()]
    parts = sorted(topic_name.split('/'))
    turned = [name for name in others if sorted(name.split('/')) == parts]
    close = difflib.get_close_matches(topic_name, others, n=1, cutoff=0.6)
    return next(iter([*same_end, *turned, *close]), None)
