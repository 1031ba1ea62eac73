"""A process of this domain runs on this machine, but is not on the graph."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Finding, GraphEvidence


def examine(evidence: GraphEvidence) -> Iterator[Finding]:
    """Suspect the discovery range if an end is missing and a process is not discovered."""
    missing = next((k for k in evidence.NEEDED if not evidence.ends(k)), None)
    if missing is None or evidence.missing_participants <= 0:
        return
    number = evidence.missing_participants
    yield Finding(
        title='a process that cannot be discovered',
        expected=f'every process of ROS domain {evidence.domain_id} on this machine to be found',
        seen=(
            f'{number} are running in it and not on the graph: their discovery range may be OFF'
            if number > 1
            else '1 is running in it and not on the graph: its discovery range may be OFF'
        ),
        fix='restart that node in a terminal in which this line was run',
        code='$ export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST',
        missing=missing,
    )
