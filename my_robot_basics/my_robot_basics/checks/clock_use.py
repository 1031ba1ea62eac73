"""Whether checks drive the robot's clock at all in this process."""

from rclpy.node import Node

from my_robot_basics.exchange import student

LEFT_ALONE = "the nodes' clocks are left alone"
ANOTHERS = 'another node publishes /clock'

_are_left_alone = False


def leave_alone() -> None:
    """Drive no clock from now on: a node may take a change of its clock amiss."""
    global _are_left_alone
    _are_left_alone = True


def are_left_alone() -> bool:
    """Whether no clock is driven."""
    return _are_left_alone


def why_not_driven(node: Node) -> str:
    """Why no clock can be driven, a clause; or ''.

    A node that was on two clocks is silent for as long as the other one was ahead. So the notebook
    is asked, too, which knows of a publisher before the graph does.
    """
    if _are_left_alone:
        return LEFT_ALONE
    is_anothers = node.count_publishers('/clock') or student.publishes('/clock')
    return ANOTHERS if is_anothers else ''
