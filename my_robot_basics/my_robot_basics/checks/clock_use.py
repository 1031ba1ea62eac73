"""Whether checks drive the robot's clock at all in this process."""

from rclpy.node import Node

from my_robot_basics.exchange import student

LEFT_ALONE = "the nodes' clocks are left alone"
ANOTHERS = 'another node publishes /clock'

_are_left_alone = False


def leave_alone() -> None:
    """Drive no clock from now on: some nodes fail when their clock changes."""
    global _are_left_alone
    _are_left_alone = True


def are_left_alone() -> bool:
    """Whether `leave_alone` was called."""
    return _are_left_alone


def why_not_driven(node: Node) -> str:
    """Why no clock can be driven, as a clause; '' if one can.

    A node that receives two clocks is silent for as long as one is ahead of the other. So the
    notebook is asked, too: it knows its own publishers before they are in the graph.
    """
    if _are_left_alone:
        return LEFT_ALONE
    is_anothers = node.count_publishers('/clock') or student.publishes('/clock')
    return ANOTHERS if is_anothers else ''
