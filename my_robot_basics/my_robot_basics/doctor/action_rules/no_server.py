"""The action has no server."""

from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.evidence import Finding


def examine(evidence: ActionEvidence) -> Iterator[Finding]:
    """Name the action clients without a server, and the other running nodes."""
    if evidence.servers:
        return
    sending = sorted({end.node_name for end in evidence.clients})
    types = [end.type_name for end in evidence.clients]
    others = ', '.join(name for name in evidence.nodes if name not in sending)
    yield Finding(
        title='no action server',
        expected=f'a server of {evidence.name}',
        seen=f'none; clients: {" and ".join(sending) or "none"}; other nodes: {others or "none"}',
        fix='start the node that serves it, and check that its constructor has this line; a goal'
        ' that is sent before is lost, so send it again',
        code=code.creation_line(
            'server', type_name=(types or ['/action/'])[0], name=evidence.name
        ),
        missing='server',
    )
