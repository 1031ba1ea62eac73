"""A callback waits for a missing server, and no other callback of its node can run."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Finding
from my_robot_basics.doctor.service_evidence import ServiceEvidence


def examine(evidence: ServiceEvidence) -> Iterator[Finding]:
    """Name the callback, and how it can test for the server without waiting."""
    for each in evidence.callbacks:
        if (each.waits_in, each.waits_for) != ('wait_for_service', evidence.name):
            continue
        if evidence.servers or not each.holds:
            continue
        yield Finding(
            title='a callback waits for the server',
            expected=f'the callback {each.name} of {each.node_name} to return soon',
            seen=f'it has waited in wait_for_service ({each.line}) for at least'
            f' {int(each.seconds)} s, and no other callback of {" and ".join(each.holds)} runs'
            ' meanwhile',
            fix='do not wait: call service_is_ready(), which returns at once, and ask only if it'
            ' is True',
            code='if self.client.service_is_ready():',
            broken=tuple(end for end in evidence.clients if end.node_name == each.node_name),
        )
