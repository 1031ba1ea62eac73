"""The client and the server were created with different action types."""

from collections.abc import Iterator

from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.client_types import clients_of_another_type, types_differ
from my_robot_basics.doctor.evidence import Finding


def examine(evidence: ActionEvidence) -> Iterator[Finding]:
    """Name both types; the server's type is taken as the right one."""
    for client, server, type_name in clients_of_another_type(evidence.servers, evidence.clients):
        yield types_differ(
            client,
            type_name,
            evidence.name,
            expected='one action type at both ends',
            seen=f'{server} serves {type_name}, {client.node_name} sends goals of'
            f' {client.type_name}: none arrives',
        )
