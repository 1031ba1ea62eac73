"""Clients whose type differs from that of the server of their service or action."""

from collections.abc import Iterable, Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Endpoint, Finding


def clients_of_another_type(
    servers: Iterable[Endpoint], clients: Iterable[Endpoint]
) -> Iterator[tuple[Endpoint, str, str]]:
    """Yield each such client, a server's node, and the server's type, which is taken as right."""
    types = {server.type_name: server.node_name for server in servers}
    for client in clients:
        if types and client.type_name not in types:
            type_name, server = next(iter(types.items()))
            yield client, server, type_name


def types_differ(
    client: Endpoint, type_name: str, name: str, *, expected: str, seen: str
) -> Finding:
    """Return the finding about a client whose type should be `type_name`."""
    return Finding(
        title='types differ',
        expected=expected,
        seen=seen,
        fix=f'use the same type in {client.node_name}'
        f' (from {type_name.replace("/", ".").rpartition(".")[0]})',
        code=code.creation_line('client', type_name=type_name, name=name),
        broken=(client,),
    )
