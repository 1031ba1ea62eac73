"""A subscription requests a stronger QoS policy than a publisher offers."""

from collections.abc import Iterator

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Evidence, Finding
from my_robot_basics.graph.qos_compatibility import incompatible_policies


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name each pair of ends that does not match, the policies, and the subscription's fix."""
    for subscription in evidence.subscriptions:
        for publisher in evidence.publishers:
            if publisher.type_name != subscription.type_name:
                continue
            offered, asked = publisher.qos_profile, subscription.qos_profile
            gaps = incompatible_policies(offered, asked)
            if not gaps:
                continue
            names = ' and '.join(gaps)
            yield Finding(
                title=f'QoS incompatible: {names}',
                expected=f'{publisher.node_name} to offer what {subscription.node_name} requests',
                seen='; '.join(
                    f'{policy}: {publisher.node_name} offers {has}, {subscription.node_name}'
                    f' requests {wants}'
                    for policy, (has, wants) in gaps.items()
                ),
                fix=f'request no more than is offered, in {subscription.node_name}',
                code=code.creation_line(
                    'subscription',
                    type_name=subscription.type_name,
                    name=evidence.name,
                    qos_profile=_compatible_profile(offered, asked),
                ),
                broken=(subscription,),
            )


def _compatible_profile(offered: QoSProfile, asked: QoSProfile) -> str:
    """Return a compatible QoSProfile as Python code, as close to the requested one as possible."""
    gaps = incompatible_policies(offered, asked)
    reliable = asked.reliability == ReliabilityPolicy.RELIABLE and 'RELIABILITY' not in gaps
    parts = ['depth=10', f'reliability=ReliabilityPolicy.{_RELIABILITY[reliable]}']
    if asked.durability == DurabilityPolicy.TRANSIENT_LOCAL and 'DURABILITY' not in gaps:
        parts.append('durability=DurabilityPolicy.TRANSIENT_LOCAL')
    # policies that are left out have defaults that any offer satisfies
    return f'QoSProfile({", ".join(parts)})'


_RELIABILITY = {True: 'RELIABLE', False: 'BEST_EFFORT'}
