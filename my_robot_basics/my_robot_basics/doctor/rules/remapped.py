"""An end was given another name where its node was started."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Show the command without the remapping rule that moved an end away."""
    for kind in 'publisher', 'subscription':
        if evidence.ends(kind):
            continue
        for remap in evidence.remaps:
            moved = [
                end
                for end in evidence.endpoints
                if (end.kind, end.topic_name) == (kind, remap.instead)
            ]
            if remap.name != evidence.topic_name or not moved:
                continue
            yield Finding(
                title='remapped',
                expected=f'a {kind} on {evidence.topic_name}',
                seen=f'{moved[0].node_name} was started with -r {remap.name}:={remap.instead},'
                ' and uses that name instead',
                fix='stop it, and start it without the rule',
                code=f'$ {remap.command}',
                broken=(moved[0],),
                missing=kind,
            )
