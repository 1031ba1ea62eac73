"""Names and types on the graph, as a node sees it."""

from typing import TYPE_CHECKING, Any

from my_robot_basics.ros2.errors import CommandError

if TYPE_CHECKING:
    from rclpy.node import Node


def full_name(node: 'Node', name: str, *, is_service: bool = False) -> str:
    """Return a topic's or service's full name; raises CommandError for an invalid one."""
    from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name
    from rclpy.validate_topic_name import validate_topic_name

    try:
        # first, because its message says what is wrong; that of the expansion does not
        validate_topic_name(name, is_service=is_service)
        full = expand_topic_name(name, node.get_name(), node.get_namespace())
        validate_full_topic_name(full, is_service=is_service)
    except (ValueError, InvalidTopicNameException, InvalidServiceNameException) as error:
        raise CommandError(str(error)) from None
    return full


def types(node: 'Node', full_name: str) -> list[str]:
    """Return the current types of a topic."""
    return dict(node.get_topic_names_and_types()).get(full_name, [])


def message_class(node: 'Node', topic_name: str) -> Any:
    """Return a topic's message class, or None while the topic does not exist.

    Raises CommandError for a topic with two types, and for a type that is not installed.
    """
    from my_robot_basics.ros2 import interfaces

    found = types(node, full_name(node, topic_name))
    if len(found) > 1:
        raise CommandError(
            f"Cannot echo topic '{topic_name}', as it contains more than one type: "
            f'[{", ".join(found)}]'
        )
    if not found:
        return None
    class_ = interfaces.message_class(found[0])
    if class_ is None:
        raise CommandError(f"The message type '{found[0]}' is invalid")
    return class_


def visible(
    names_and_types: list[tuple[str, list[str]]], include_hidden: bool
) -> list[tuple[str, list[str]]]:
    """Return topics or services without the hidden ones, or all with `include_hidden`."""
    from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

    return [
        (name, types)
        for name, types in names_and_types
        if include_hidden or not topic_or_service_is_hidden(name)
    ]
