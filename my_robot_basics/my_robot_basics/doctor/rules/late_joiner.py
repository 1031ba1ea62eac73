"""A subscription does not receive messages that were published before it joined."""

from collections.abc import Iterator

from rclpy.qos import DurabilityPolicy

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name VOLATILE subscriptions to a topic whose messages were all sent before the look."""
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
