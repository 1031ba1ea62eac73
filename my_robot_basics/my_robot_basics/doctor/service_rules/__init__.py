"""Rules about the faults of a service, one in each file; some are those of `doctor.rules`.

`RULES` is in the order of likelihood: a cause comes before the consequence that it explains.
"""

from collections.abc import Callable, Iterable

from my_robot_basics.doctor.evidence import Diagnosis, Finding
from my_robot_basics.doctor.rules import (
    blocks_itself,
    discovery_range,
    not_returning,
    other_domain,
    remapped,
    similar_name,
)
from my_robot_basics.doctor.service_evidence import ServiceEvidence
from my_robot_basics.doctor.service_rules import (
    no_server,
    not_spinning,
    raised,
    several_servers,
    types_differ,
    waits_for_server,
)

RULES: tuple[Callable[[ServiceEvidence], Iterable[Finding]], ...] = (
    remapped.examine,
    similar_name.examine,
    discovery_range.examine,
    other_domain.examine,
    no_server.examine,
    waits_for_server.examine,
    types_differ.examine,
    several_servers.examine,
    blocks_itself.examine,
    raised.examine,
    not_spinning.examine,
    not_returning.examine,
)


def judge(evidence: ServiceEvidence) -> Diagnosis:
    """Return all findings of the rules, the likeliest first."""
    findings = tuple(finding for examine in RULES for finding in examine(evidence))
    return Diagnosis(evidence, findings)
