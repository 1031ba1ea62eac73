"""The callback of the service has raised an exception, so that the request got no response."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Finding
from my_robot_basics.doctor.service_evidence import ServiceEvidence

NO_RESPONSE = 'TypeError'
"""All that rclpy reports if a callback does not return a response of the right type."""


def examine(evidence: ServiceEvidence) -> Iterator[Finding]:
    """Name the exception, or explain rclpy's bare TypeError."""
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
