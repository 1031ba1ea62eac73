"""The execute callback has not set its goal's status, so that rclpy aborted the goal."""

from collections.abc import Iterator

from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.evidence import Finding


def examine(evidence: ActionEvidence) -> Iterator[Finding]:
    """Show the missing line; callbacks that raised are left out, as they could not reach it."""
    for node_name in sorted(evidence.unset - {name for name, _ in evidence.raised}):
        yield Finding(
            title='nobody has set how the goal ended',
            expected=f'the execute callback of {node_name} to call succeed(), canceled() or'
            ' abort() before it returns',
            seen='it returned without, a moment ago: rclpy aborts such a goal',
            fix='call it when the goal is reached, before the callback returns',
            code='goal_handle.succeed()',
            broken=tuple(end for end in evidence.servers if end.node_name == node_name),
        )
