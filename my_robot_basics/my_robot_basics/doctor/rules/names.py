"""Rules about names: an end of the graph that has another name than the one that was asked for."""

import difflib
from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import VERBS, Endpoint, Finding, GraphEvidence, Kind


def remapped(evidence: GraphEvidence) -> Iterator[Finding]:
    """A remapping rule gave an end another name when its node was started.

    Show the command without the remapping rule that renamed the end.
    """
    for kind in evidence.NEEDED:
        if evidence.ends(kind):
            continue
        for remap in evidence.remaps:
            moved = [
                end for end in evidence.endpoints if (end.kind, end.name) == (kind, remap.instead)
            ]
            if remap.name != evidence.name or not moved:
                continue
            yield Finding(
                title='remapped',
                expected=f'a {kind} {evidence.OF} {evidence.name}',
                seen=f'{moved[0].node_name} was started with -r {remap.name}:={remap.instead},'
                ' and uses that name instead',
                fix='stop it, and start it without the rule',
                code=f'$ {remap.command}',
                broken=(moved[0],),
                missing=kind,
            )


CUTOFF = 0.75


def similar_name(evidence: GraphEvidence) -> Iterator[Finding]:
    """An end is missing, and another one has a similar name, which may be misspelled.

    Show the line to edit; if no node uses the given name, show a similar one to diagnose.
    """
    if not any(evidence.ends(kind) for kind in evidence.KINDS):
        yield from _misspelt_question(evidence)
        return
    for kind in evidence.KINDS:
        if evidence.ends(kind):
            continue
        verb = f'{VERBS[kind]} on' if kind in ('publisher', 'subscription') else VERBS[kind]
        for end in _similar(evidence, kind)[:1]:
            how = _difference(end.name, evidence.name)
            wrong, right = _wrong_end(evidence, end)
            uses = f'{end.node_name} {verb} {end.name}'
            why = _why(wrong, right)
            yield Finding(
                title=f'a similar name: {how}',
                expected=f'a {kind} {evidence.OF} {evidence.name}',
                seen=f'none, and {uses} ({how}): {why}' if why else f'none, and {uses} ({how})',
                fix=f'if {right} is right, write it in {wrong.node_name} (or start '
                f'that with --ros-args -r {wrong.name}:={right})',
                code=code.creation_line(wrong.kind, type_name=wrong.type_name, name=right),
                broken=(wrong,),
                missing=kind,
            )


def _wrong_end(evidence: GraphEvidence, other: Endpoint) -> tuple[Endpoint, str]:
    """Return the end to edit, and the name that it should have.

    It is an end of the diagnosed name if that is relative by mistake; else `other`.
    """
    for end in evidence.endpoints:
        if end.name == evidence.name and _is_relative(end, other.name):
            return end, other.name
    return other, evidence.name


def _is_relative(end: Endpoint, name: str) -> bool:
    """Whether the end would have this name without its node's namespace."""
    return end.name != name and end.name == f'{end.node_name.rpartition("/")[0]}{name}'


def _why(end: Endpoint, name: str) -> str:
    if not _is_relative(end, name):
        return ''
    return f"in {end.node_name}, a name without a leading / begins with the node's namespace"


def _misspelt_question(evidence: GraphEvidence) -> Iterator[Finding]:
    first, second = evidence.KINDS if evidence.OF == 'on' else reversed(evidence.KINDS)
    for end in _similar(evidence, first)[:1] or _similar(evidence, second)[:1]:
        how = _difference(end.name, evidence.name)
        yield Finding(
            title=f'a similar name: {how}',
            expected=f'a node that uses {evidence.name}',
            seen=f'none, and {end.node_name} uses {end.name} ({how})',
            fix='run the doctor on that name, if it is the one you mean',
            code=f'$ topic_doctor {end.name}',
            broken=(end,),
            missing=end.kind,
        )


def _similar(evidence: GraphEvidence, kind: Kind) -> list[Endpoint]:
    """Return ends of that kind with similar names; first those whose other end is missing."""
    met = {
        end.name
        for end in evidence.endpoints
        if end.kind != kind  # the name has an end of the other kind
    }
    near = [
        end
        for end in evidence.endpoints
        if end.kind == kind
        and are_similar(end.name, evidence.name)
        # clients of a similar name that has a server are not misspelled
        and (kind != 'client' or end.name not in met)
    ]
    wanted = evidence.name
    return sorted(near, key=lambda end: (end.name in met, -_similarity(end.name, wanted)))


def are_similar(one: str, other: str) -> bool:
    """Whether one of two names may be a misspelling of the other."""
    return _similarity(one, other) >= CUTOFF


def _similarity(one: str, other: str) -> float:
    """Return 0 to 1; the same last part counts as much as a small typing error."""
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


def _last(name: str) -> str:
    return name.rpartition('/')[2].lower()
