"""A node is not spun: it takes neither requests nor responses."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Finding
from my_robot_basics.doctor.service_evidence import ServiceEvidence

_JOBS = {'server': 'requests are taken', 'client': 'responses are taken'}


def examine(evidence: ServiceEvidence) -> Iterator[Finding]:
    """Name servers and clients whose nodes do not answer requests.

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
