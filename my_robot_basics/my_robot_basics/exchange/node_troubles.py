"""What keeps a node of the notebook from its work, where the notebook's process knows.

It tells students where to look; the verdict stays with what was seen.
"""

from my_robot_basics.exchange import wire
from my_robot_basics.exchange.asking import told
from my_robot_basics.feedback.errors import shorten


def last_raised(node_name: str) -> str:
    """What a callback of that node raised last, where the notebook's process knows; or ''."""
    body = told(wire.request(op='trouble', name=node_name))
    return shorten(body) if isinstance(body, str) else ''


def unpublished_field(node_name: str) -> tuple[str, str]:
    """For which field a message of that node did not travel, and its type; or texts of ''.

    Without a field, the type is how to make what rclpy was to be given.
    """
    body = told(wire.request(op='field', name=node_name))
    is_told = isinstance(body, tuple) and [type(text) for text in body] == [str, str]
    return (shorten(body[0], 60), shorten(body[1], 60)) if is_told else ('', '')


def times_raised(node_name: str) -> int:
    """How often a callback of that node raised, where the notebook's process knows; or 0."""
    body = told(wire.request(op='raised', name=node_name))
    return body if type(body) is int else 0


def unfinished(node_name: str) -> str:
    """Where a callback of that node is that keeps all others from running: its line, or ''."""
    body = told(wire.request(op='unfinished', name=node_name))
    return shorten(body) if isinstance(body, str) else ''
