"""The client and the server were created with different service types."""

from collections.abc import Iterator

from my_robot_basics.doctor.client_types import clients_of_another_type, types_differ
from my_robot_basics.doctor.evidence import Finding
from my_robot_basics.doctor.service_evidence import ServiceEvidence


def examine(evidence: ServiceEvidence) -> Iterator[Finding]:
    """Name both types; the server's type is taken as the right one."""
    for client, server, type_name in clients_of_another_type(evidence.servers, evidence.clients):
        yield types_differ(
            client,
            type_name,
            evidence.name,
            expected='one service type at both ends',
            seen=f'{server} serves {type_name}, {client.node_name} asks for'
            f' {client.type_name}: no request arrives',
        )
