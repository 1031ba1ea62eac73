"""The execute callback has raised an exception, so that its goal was aborted."""

from collections.abc import Iterator

from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.evidence import Finding


def examine(evidence: ActionEvidence) -> Iterator[Finding]:
    """Say what was raised."""
    for node_name, what in evidence.raised:
        seen = f'it raised an exception a moment ago ({what}), and the goal was aborted'
        fix = 'fix that, and send the goal again'
        if not what:  # as the TypeError of publish_feedback
            seen = 'it raised an exception without a text a moment ago, and the goal was aborted'
            fix = (
                "give publish_feedback an object of the action's Feedback, such as "
                'MoveArm.Feedback(position=…, remaining=…), and send the goal again'
            )
        yield Finding(
            title='the execute callback raised',
            expected=f'the execute callback of {node_name} to return a result',
            seen=seen,
            fix=fix,
            broken=tuple(end for end in evidence.servers if end.node_name == node_name),
        )
