"""Rules about the faults of a service; some are those of `doctor.rules`.

`RULES` is in the order of likelihood: a cause comes before the consequence that it explains.
"""

from collections.abc import Callable, Iterable, Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.client_types import clients_of_another_type, types_differ
from my_robot_basics.doctor.evidence import Diagnosis, Finding
from my_robot_basics.doctor.rules import callbacks, endpoints, names
from my_robot_basics.doctor.served_evidence import ServiceEvidence


def no_server(evidence: ServiceEvidence) -> Iterator[Finding]:
    """The service has no server.

    Name the clients without a server, and the other running nodes.
    """
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


def waits_for_server(evidence: ServiceEvidence) -> Iterator[Finding]:
    """A callback waits for a missing server, and no other callback of its node can run.

    Name the callback, and how it can test for the server without waiting.
    """
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


def different_types(evidence: ServiceEvidence) -> Iterator[Finding]:
    """The client and the server were created with different service types.

    Name both types; the server's type is taken as the right one.
    """
    for client, server, type_name in clients_of_another_type(evidence.servers, evidence.clients):
        yield types_differ(
            client,
            type_name,
            evidence.name,
            expected='one service type at both ends',
            seen=f'{server} serves {type_name}, {client.node_name} asks for'
            f' {client.type_name}: no request arrives',
        )


def several_servers(evidence: ServiceEvidence) -> Iterator[Finding]:
    """Several nodes serve one name: each handles a request, but the client gets one response.

    Name the nodes, and the consequence.
    """
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


NO_RESPONSE = 'TypeError'
"""All that rclpy reports if a callback does not return a response of the right type."""


def raised(evidence: ServiceEvidence) -> Iterator[Finding]:
    """The callback of the service has raised an exception, so that the request got no response.

    Name the exception, or explain rclpy's bare TypeError.
    """
    for server in evidence.servers:
        raised = evidence.raised.get(server.node_name, '')
        if not raised:
            continue
        no_response = raised == NO_RESPONSE
        response = f'{server.type_name.rpartition("/")[2]}.Response'
        yield Finding(
            title='the callback returned no response' if no_response else 'the callback raised',
            expected=f'the callback of {evidence.name} in {server.node_name} to return a'
            f' {response}',
            seen='it returned something else, or nothing, which rclpy reports as TypeError: no'
            ' response was sent'
            if no_response
            else f'it raised {raised}: no response was sent',
            fix='end the callback with this line, in each of its branches; then ask again'
            if no_response
            else 'fix that, and ask again; rclpy.spin would have ended there',
            code='return response' if no_response else '',
            broken=(server,),
        )


_JOBS = {'server': 'requests are taken', 'client': 'responses are taken'}


def not_spinning(evidence: ServiceEvidence) -> Iterator[Finding]:
    """A node is not spun: it takes neither requests nor responses.

    Name servers and clients whose nodes do not answer requests.

    A client of this process without a pending request is left out: it may be spun later.
    """
    waiting = {each.node_name for each in evidence.unanswered}
    for end in evidence.servers + evidence.clients:
        if evidence.busy(end.node_name) or evidence.state(end.node_name).answers is not False:
            continue
        is_known = end.node_name in evidence.visible
        if is_known and end.node_name not in evidence.unspun:
            continue
        if is_known and end.kind == 'client' and end.node_name not in waiting:
            continue
        yield Finding(
            title='the node is not spinning' if is_known else 'the node answers nothing',
            expected=f'{end.node_name} to be spun, so that {_JOBS[end.kind]}',
            seen=_seen(evidence, end.node_name),
            fix='spin it; in a notebook, start it with live.run(…). If it was spinning, an'
            ' exception in a callback has ended that, or a callback does not return: read its log',
            code='rclpy.spin(node)',
            broken=(end,),
        )


def _seen(evidence: ServiceEvidence, node_name: str) -> str:
    if node_name in evidence.taken:
        return (
            'no thread spins it; rclpy.spin_until_future_complete, spin_once or spin was called'
            ' with it, which takes a node away for good from the executor that spun it before'
        )
    if node_name in evidence.unspun:
        return 'no thread spins it'
    return (
        f'it has answered nothing for at least {int(evidence.looked_sec)} s: it is not spun, or a'
        ' callback has not returned in this time'
    )


RULES: tuple[Callable[[ServiceEvidence], Iterable[Finding]], ...] = (
    names.remapped,
    names.similar_name,
    endpoints.discovery_range,
    endpoints.other_domain,
    no_server,
    waits_for_server,
    different_types,
    several_servers,
    callbacks.blocks_itself,
    raised,
    not_spinning,
    callbacks.not_returning,
)


def judge(evidence: ServiceEvidence) -> Diagnosis:
    """Return all findings of the rules, the likeliest first."""
    findings = tuple(finding for examine in RULES for finding in examine(evidence))
    return Diagnosis(evidence, findings)
