"""Rules about messages that were published: which are lost, and what is wrong in them."""

import itertools
import math
from collections.abc import Iterator
from typing import Any

from rclpy.qos import DurabilityPolicy

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Evidence, Finding


def late_joiner(evidence: Evidence) -> Iterator[Finding]:
    """A subscription does not receive messages that were published before it joined.

    Name VOLATILE subscriptions to a topic whose messages were all sent before the look.
    """
    if evidence.fresh or not evidence.received:
        return
    ago_sec = evidence.start_sec - evidence.received[-1].sent_sec
    for subscription in evidence.subscriptions:
        if subscription.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            continue
        wanted = (
            'QoSProfile(depth=10, reliability=ReliabilityPolicy.'
            f'{subscription.qos_profile.reliability.name},'
            ' durability=DurabilityPolicy.TRANSIENT_LOCAL)'
        )
        yield Finding(
            title='joined too late',
            expected=f'{subscription.node_name} to request messages published before it'
            ' joined (durability TRANSIENT_LOCAL)',
            seen='it requests VOLATILE, and the last message was sent'
            f' {ago_sec:.1f} s before the doctor started',
            fix=f'request the kept messages in {subscription.node_name}',
            code=code.creation_line(
                'subscription',
                type_name=subscription.type_name,
                name=evidence.name,
                qos_profile=wanted,
            ),
            broken=(subscription,),
        )


FEWEST = 5
"""A burst has at least so many messages, and more than two of each publisher, as timers of several
publishers may fire at the same time."""
PART_IN_BURSTS = 0.5
"""At least this part of all messages must be in bursts: a busy machine causes one or two."""


def short_queue(evidence: Evidence) -> Iterator[Finding]:
    """Messages come in bursts that are longer than a queue.

    Name queues that are shorter than a burst, of nodes whose depths are known.
    """
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


MOST_OFF_SEC = 1.0
LONG_SEC = 0.5
"""If all messages over a longer time have one stamp, it is wrong, and they are not one burst."""


def stamps(evidence: Evidence) -> Iterator[Finding]:
    """Messages arrive, but with stamps for which other nodes drop them.

    Report stamps of zero, stamps far from the sending time, and stamps that never change.
    """
    stamped = [each for each in evidence.fresh if hasattr(each.message, 'header')]
    if not stamped:
        return
    stamps = [each.message.header.stamp for each in stamped]
    times = [stamp.sec + stamp.nanosec * 1e-9 for stamp in stamps]
    simulated = any(evidence.state(end.node_name).use_sim_time for end in evidence.publishers)
    off_sec = max(
        (time - each.sent_sec for time, each in zip(times, stamped, strict=True)), key=abs
    )
    if 0.0 in times:
        seen = 'a stamp of 0, as if the message were from 1970'
    elif not simulated and abs(off_sec) > MOST_OFF_SEC:
        side = 'ahead of' if off_sec > 0.0 else 'behind'
        seen = f'a stamp {abs(off_sec):.1f} s {side} it'
    elif len(set(times)) == 1 and stamped[-1].sent_sec - stamped[0].sent_sec > LONG_SEC:
        seen = 'the same stamp on every message'
    else:
        return
    yield Finding(
        title='stamps missing or old',
        expected="the time of sending in each message's header.stamp",
        seen=f'{seen}: tf2, RViz2 and message filters drop such messages',
        fix='set the stamp just before each publish',
        code='message.header.stamp = self.get_clock().now().to_msg()',
        broken=evidence.publishers,
    )


TURN_DEG = 360.0
_TURNS_FOREVER = ('wheel', 'continuous', 'propeller', 'rotor')
"""Parts of the names of continuous joints, which may be at many radians."""


def degrees(evidence: Evidence) -> Iterator[Finding]:
    """Messages arrive, and angles look like degrees instead of radians.

    Name the largest position if it is more than a turn in radians, but not in degrees.
    """
    angles = [angle for each in evidence.received for angle in _angles(each.message)]
    sizes = [abs(angle) for angle in angles if math.isfinite(angle)]
    if not sizes or not math.tau < max(sizes) <= TURN_DEG:
        return
    shown = max(angles, key=lambda angle: abs(angle) if math.isfinite(angle) else 0.0)
    yield Finding(
        title='degrees instead of radians',
        expected='angles in radians in message.position (a full turn is 6.283)',
        seen=f'{shown:.1f}, which looks like degrees:'
        f' as radians it is {abs(shown) / math.tau:.1f} turns',
        fix='convert before you publish',
        code='message.position = [math.radians(angle) for angle in message.position]',
        broken=evidence.publishers,
    )


def _angles(message: Any) -> list[float]:
    """Return the positions of a JointState's joints, without continuous ones."""
    if type(message).__name__ != 'JointState':
        return []
    return [
        angle
        for name, angle in zip(message.name, message.position, strict=False)
        if not any(word in name.lower() for word in _TURNS_FOREVER)
    ]
