"""Rules about the faults of an action, one in each file; some are those of `doctor.rules`.

`RULES` is in the order of likelihood: a cause comes before the consequence that it explains.
"""

from collections.abc import Callable, Iterable

from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.action_rules import (
    no_server,
    raised,
    stands_still,
    types_differ,
    unset_status,
)
from my_robot_basics.doctor.evidence import Diagnosis, Finding
from my_robot_basics.doctor.rules import (
    blocks_itself,
    discovery_range,
    not_returning,
    other_domain,
    remapped,
    similar_name,
)

RULES: tuple[Callable[[ActionEvidence], Iterable[Finding]], ...] = (
    remapped.examine,
    similar_name.examine,
    discovery_range.examine,
    other_domain.examine,
    no_server.examine,
    types_differ.examine,
    blocks_itself.examine,
    raised.examine,
    unset_status.examine,
    not_returning.examine,
    stands_still.examine,
)


def judge(evidence: ActionEvidence) -> Diagnosis:
    """Return all findings of the rules, the likeliest first."""
    findings = tuple(finding for examine in RULES for finding in examine(evidence))
    return Diagnosis(evidence, findings)
