"""Rules about the faults of a topic, one in each file: `examine(evidence)` yields findings.

`RULES` is in the order of likelihood: a cause comes before the consequence that it explains.
"""

from collections.abc import Callable, Iterable

from my_robot_basics.doctor.evidence import Diagnosis, Evidence, Finding
from my_robot_basics.doctor.rules import (
    blocks_itself,
    degrees,
    discovery_range,
    late_joiner,
    no_clock,
    no_publisher,
    no_subscription,
    not_installed,
    not_returning,
    not_spinning,
    other_domain,
    qos,
    remapped,
    short_queue,
    silent_publisher,
    similar_name,
    stamps,
    types_differ,
)

RULES: tuple[Callable[[Evidence], Iterable[Finding]], ...] = (
    remapped.examine,
    similar_name.examine,
    discovery_range.examine,
    other_domain.examine,
    no_publisher.examine,
    no_subscription.examine,
    types_differ.examine,
    not_installed.examine,
    qos.examine,
    no_clock.examine,
    blocks_itself.examine,
    not_returning.examine,
    not_spinning.examine,
    silent_publisher.examine,
    late_joiner.examine,
    short_queue.examine,
    stamps.examine,
    degrees.examine,
)


def judge(evidence: Evidence) -> Diagnosis:
    """Return all findings of the rules, the likeliest first."""
    findings = tuple(finding for examine in RULES for finding in examine(evidence))
    return Diagnosis(evidence, findings)
