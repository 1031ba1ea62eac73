"""What DDS allows on the graph and ROS does not: rclpy raises if it should look it up."""

from collections.abc import Iterator

from rclpy.exceptions import NameValidationException
from rclpy.node import Node
from rclpy.validate_full_topic_name import validate_full_topic_name


def strange_name(node: Node) -> str:
    """Return one that the node sees now; '' if there is none, or a name is not UTF-8."""
    try:
        return next((name for name in _names(node) if not _is_allowed(name)), '')
    except UnicodeDecodeError:
        return ''


def has_strange_duration(node: Node) -> bool:
    """Whether an endpoint that the node sees now announces QoS with a negative time."""
    topic_names = [name for name, _ in node.get_topic_names_and_types()]
    try:
        for look_up in node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic:
            for name in topic_names:
                look_up(name)
    except OverflowError:
        return True
    return False


def _names(node: Node) -> Iterator[str]:
    """Yield the full names of topics, services and nodes, to which the same rules apply."""
    for look_up in node.get_topic_names_and_types, node.get_service_names_and_types:
        yield from (name for name, _ in look_up())
    for name, namespace in node.get_node_names_and_namespaces():
        yield f'{namespace.rstrip("/")}/{name}'


def _is_allowed(name: str) -> bool:
    try:
        return validate_full_topic_name(name)
    except NameValidationException:
        return False
