"""The execute callback has raised an exception, so that its goal was aborted."""

from collections.abc import Iterator

from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.evidence import Finding


def examine(evidence: ActionEvidence) -> Iterator[Finding]:
    """Say what was raised."""
    for node_name, what in evidence.raised:
        yield Finding(
            title='the execute callback raised',
            expected=f'the execute callback of {node_name} to return a result',
            seen=f'it raised an exception a moment ago ({what}), and the goal was aborted',
            fix='fix that, and send the goal again',
            broken=tuple(end for end in evidence.servers if end.node_name == node_name),
        )
