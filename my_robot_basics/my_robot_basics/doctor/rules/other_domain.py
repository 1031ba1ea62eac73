"""The other end is on this machine, in another ROS domain."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import VERBS, Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name the domain, if the neighbouring ones were looked at."""
    for kind, verb in VERBS.items():
        if evidence.ends(kind):
            continue
        for domain_id, ends in evidence.elsewhere.items():
            found = [end for end in ends if end.kind == kind]
            if not found:
                continue
            who = found[0].node_name
            yield Finding(
                title='another domain ID',
                expected=f'a {kind} on {evidence.topic_name} in ROS domain {evidence.domain_id}',
                seen=f'{who} {verb} there in domain {domain_id}: different domains never meet',
                fix=f'start {who} again in a terminal in which this line was run',
                code=f'$ export ROS_DOMAIN_ID={evidence.domain_id}',
                broken=(found[0],),
                missing=kind,
            )
