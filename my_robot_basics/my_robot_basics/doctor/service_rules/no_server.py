"""The service has no server."""

from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Finding
from my_robot_basics.doctor.service_evidence import ServiceEvidence


def examine(evidence: ServiceEvidence) -> Iterator[Finding]:
    """Name the clients without a server, and the other running nodes."""
    if evidence.servers:
        return
    asking = sorted({end.node_name for end in evidence.clients})
    types = [end.type_name for end in evidence.clients]
    others = ', '.join(name for name in evidence.nodes if name not in asking)
    seen = 'none; nobody asks it'
    if asking:
        names = ' and '.join(asking)
        seen = f'none; {names} ask it' if len(asking) > 1 else f'none; {names} asks it'
    yield Finding(
        title='no server',
        expected=f'a server of {evidence.name}',
        seen=f'{seen}, and {f"these run, too: {others}" if others else "no other node runs"}',
        fix='start the node that serves it, and check that its constructor has this line; a'
        ' request that is sent before is lost, so ask for it again',
        code=code.creation_line('server', type_name=(types or [''])[0], name=evidence.name),
        missing='server',
    )
