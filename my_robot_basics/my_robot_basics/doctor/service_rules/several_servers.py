"""Several nodes serve one name: each handles a request, but the client gets one response."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Finding
from my_robot_basics.doctor.service_evidence import ServiceEvidence


def examine(evidence: ServiceEvidence) -> Iterator[Finding]:
    """Name the nodes, and the consequence."""
    if len(evidence.servers) < 2:
        return
    names = sorted({end.node_name for end in evidence.servers})
    yield Finding(
        title='several servers',
        expected=f'one server of {evidence.name}',
        seen=f'{len(evidence.servers)} servers, of {" and ".join(names)}: each of them works on'
        ' each request, and the client takes the response that comes first',
        fix='stop all but one of these nodes, or let the others serve another name',
    )
