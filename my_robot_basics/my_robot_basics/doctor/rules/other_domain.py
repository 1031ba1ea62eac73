"""The other end is on this machine, in another ROS domain."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import VERBS, Finding, GraphEvidence


def examine(evidence: GraphEvidence) -> Iterator[Finding]:
    """Name the domain, if other domains were searched."""
    for kind in evidence.NEEDED:
        if evidence.ends(kind):
            continue
        for domain_id, ends in evidence.elsewhere.items():
            found = [end for end in ends if end.kind == kind]
            if not found:
                continue
            who, where = found[0].node_name, f'ROS domain {evidence.domain_id}'
            yield Finding(
                title='another domain ID',
                expected=f'a {kind} on {evidence.name} in {where}'
                if evidence.OF == 'on'
                else f'a {kind} of {evidence.name} in {where}',
                seen=f'{who} {VERBS[kind]} there in domain {domain_id}: different domains'
                ' never meet',
                fix=f'start {who} again in a terminal in which this line was run',
                code=f'$ export ROS_DOMAIN_ID={evidence.domain_id}',
                broken=(found[0],),
                missing=kind,
            )
