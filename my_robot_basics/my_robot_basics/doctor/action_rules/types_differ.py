"""The client and the server were made with different action types."""

from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.evidence import Finding


def examine(evidence: ActionEvidence) -> Iterator[Finding]:
    """Name both types; the server's counts as right."""
    types = {server.type_name: server.node_name for server in evidence.servers}
    for client in evidence.clients:
        if not types or client.type_name in types:
            continue
        type_name, server = next(iter(types.items()))
        yield Finding(
            title='types differ',
            expected='one action type at both ends',
            seen=f'{server} serves {type_name}, {client.node_name} sends goals of'
            f' {client.type_name}: none arrives',
            fix=f'use the same type in {client.node_name}'
            f' (from {type_name.replace("/", ".").rpartition(".")[0]})',
            code=code.create('client', type_name=type_name, name=evidence.name),
            broken=(client,),
        )
