"""An end is missing, and another topic has a name that may have been meant."""

import difflib
from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import VERBS, Endpoint, Evidence, Finding, Kind

CUTOFF = 0.75


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Show the edit, or the name to ask for where nobody uses the one that was given."""
    if not (evidence.publishers or evidence.subscriptions):
        yield from _misspelt_question(evidence)
        return
    for kind, verb in VERBS.items():
        if evidence.ends(kind):
            continue
        for end in _similar(evidence, kind)[:1]:
            how = _difference(end.topic_name, evidence.topic_name)
            yield Finding(
                title=f'a similar name: {how}',
                expected=f'a {kind} on {evidence.topic_name}',
                seen=f'none, and {end.node_name} {verb} on {end.topic_name} ({how})',
                fix=f'if {evidence.topic_name} is right, write it in {end.node_name} (or start '
                f'that with --ros-args -r {end.topic_name}:={evidence.topic_name})',
                code=code.create(kind, type_name=end.type_name, topic_name=evidence.topic_name),
                broken=(end,),
                missing=kind,
            )


def _misspelt_question(evidence: Evidence) -> Iterator[Finding]:
    for end in _similar(evidence, 'publisher')[:1] or _similar(evidence, 'subscription')[:1]:
        how = _difference(end.topic_name, evidence.topic_name)
        yield Finding(
            title=f'a similar name: {how}',
            expected=f'a node that uses {evidence.topic_name}',
            seen=f'none, and {end.node_name} uses {end.topic_name} ({how})',
            fix='run the doctor on that topic, if it is the one you mean',
            code=f'$ topic_doctor {end.topic_name}',
            broken=(end,),
            missing=end.kind,
        )


def _similar(evidence: Evidence, kind: Kind) -> list[Endpoint]:
    """Ends of that kind on topics of similar names; first those that wait for the other end."""
    met = {
        end.topic_name
        for end in evidence.endpoints
        if end.kind != kind  # somebody is there at the other end
    }
    near = [
        end
        for end in evidence.endpoints
        if end.kind == kind and _likeness(end.topic_name, evidence.topic_name) >= CUTOFF
    ]
    wanted = evidence.topic_name
    return sorted(
        near, key=lambda end: (end.topic_name in met, -_likeness(end.topic_name, wanted))
    )


def _likeness(one: str, other: str) -> float:
    """0 to 1; the same last part counts as much as a small slip of the pen."""
    if _last(one) == _last(other):
        return 0.9
    return difflib.SequenceMatcher(a=one.lower(), b=other.lower()).ratio()


def _difference(one: str, other: str) -> str:
    if one.lower() == other.lower():
        return 'upper and lower case differ'
    if one.replace('/', '').lower() == other.replace('/', '').lower():
        return 'the slashes differ'
    if _last(one) == _last(other):
        return 'the namespace differs'
    return 'the spelling differs'


def _last(topic_name: str) -> str:
    return topic_name.rpartition('/')[2].lower()
