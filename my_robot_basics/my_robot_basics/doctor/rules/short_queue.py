"""Messages come in bursts that are longer than a queue."""

import itertools
from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Evidence, Finding

FEWEST = 5
"""A burst has at least so many messages, and more than two of each publisher, as timers of several
publishers may fire at the same time."""
PART_IN_BURSTS = 0.5
"""At least this part of all messages must be in bursts: a busy machine causes one or two."""


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name queues that are shorter than a burst, of nodes whose depths are known."""
    fewest = max(FEWEST, 2 * len(evidence.publishers) + 1)
    bursts = [length for length in evidence.bursts if length >= fewest]
    if not bursts or sum(bursts) < PART_IN_BURSTS * len(evidence.fresh):
        return
    burst = max(bursts)
    depth = _round(burst)
    for end in evidence.publishers + evidence.subscriptions:
        if not end.depth or end.depth >= burst:
            continue
        yield Finding(
            title='messages lost to a short queue',
            expected=f'a queue of {burst} messages in {end.node_name}: {burst} arrive at once',
            seen=f'its {end.kind} has depth {end.depth}: while it is busy, a new message pushes'
            ' the oldest out, also when RELIABLE',
            fix=f'make the queue of the {end.kind} in {end.node_name} as long as a burst',
            code=code.creation_line(
                end.kind,
                type_name=end.type_name,
                name=evidence.name,
                qos_profile=str(depth),
            ),
            broken=(end,),
        )


def _round(burst: int) -> int:
    """Round up to 10, 20, 50, 100, …, as the next burst may be a little longer."""
    return next(
        step * 10**power
        for power in itertools.count(1)
        for step in (1, 2, 5)
        if step * 10**power >= burst
    )
