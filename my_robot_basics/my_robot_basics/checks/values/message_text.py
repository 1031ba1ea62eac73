"""What the feedback shows of a message that arrived."""

from typing import Any

from sensor_msgs.msg import JointState

from my_robot_basics.checks.values import joints
from my_robot_basics.feedback.errors import shorten


def message_text(message: Any) -> str:
    """The message in one line; of a JointState only the joints, in the form of `joints.shown`."""
    return shorten(joints.shown(message) if isinstance(message, JointState) else message)
