"""A remapping rule gave an end another name when its node was started."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Finding, GraphEvidence


def examine(evidence: GraphEvidence) -> Iterator[Finding]:
    """Show the command without the remapping rule that renamed the end."""
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
