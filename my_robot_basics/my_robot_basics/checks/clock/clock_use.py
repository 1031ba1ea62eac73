"""Whether checks drive the robot's clock at all in this process, and for which nodes."""

from collections.abc import Collection, Mapping

from rclpy.node import Node

from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import expect

LEFT_ALONE = "the nodes' clocks are left alone"
ANOTHERS = 'another node publishes /clock'

_are_left_alone = False
_switched: set[str] = set()
"""The full names of all nodes that checks have switched to `/clock` in this process."""


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


def expect_wall_clock(former: Mapping[str, bool], needed: Collection[str]) -> None:
    """Expect nodes that are now switched not to have use_sim_time of their own, and note them.

    Nobody but a check publishes `/clock`, so their time would stand still. `former` has the
    use_sim_time of each node before it is switched. A node that was switched before may have its
    own from that time: on a busy machine, it may not get the former one back. Raises CheckFailed.
    """
    waiting = sorted(name for name in needed if former[name] and name not in _switched)
    _switched.update(former)
    expect(
        not waiting,
        expected="a node on the computer's clock",
        seen=f'{", ".join(waiting)} with use_sim_time',
        hint='leave use_sim_time out: such a node waits for /clock, which only a simulator '
        'publishes, and its timers are never called',
        cause='the node has use_sim_time, and nobody publishes /clock',
    )
