"""Rules about the faults of a topic: each is a function that yields findings of the evidence.

`RULES` is in the order of likelihood: a cause comes before the consequence that it explains.
"""

from collections.abc import Callable, Iterable

from my_robot_basics.doctor.evidence import Diagnosis, Evidence, Finding
from my_robot_basics.doctor.rules import callbacks, endpoints, messages, names

RULES: tuple[Callable[[Evidence], Iterable[Finding]], ...] = (
    names.remapped,
    names.similar_name,
    endpoints.discovery_range,
    endpoints.other_domain,
    endpoints.no_publisher,
    endpoints.no_subscription,
    endpoints.different_types,
    endpoints.not_installed,
    endpoints.qos,
    callbacks.no_clock,
    callbacks.blocks_itself,
    callbacks.not_returning,
    callbacks.not_spinning,
    callbacks.silent_publisher,
    messages.late_joiner,
    messages.short_queue,
    messages.stamps,
    messages.degrees,
)


def judge(evidence: Evidence) -> Diagnosis:
    """Return all findings of the rules, the likeliest first."""
    findings = tuple(finding for examine in RULES for finding in examine(evidence))
    return Diagnosis(evidence, findings)
