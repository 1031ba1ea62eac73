"""Whether two QoS profiles are compatible, and what to advise if not."""

from collections.abc import Iterable

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy


def incompatible_policies(offered: QoSProfile, asked: QoSProfile) -> dict[str, tuple[str, str]]:
    """Each policy that offers less than requested: its name, and both values in words."""
    gaps = {}
    if (
        offered.reliability == ReliabilityPolicy.BEST_EFFORT
        and asked.reliability == ReliabilityPolicy.RELIABLE
    ):
        gaps['RELIABILITY'] = ('BEST_EFFORT', 'RELIABLE')
    if (
        offered.durability == DurabilityPolicy.VOLATILE
        and asked.durability == DurabilityPolicy.TRANSIENT_LOCAL
    ):
        gaps['DURABILITY'] = ('VOLATILE', 'TRANSIENT_LOCAL')
    if offered.deadline > asked.deadline:
        gaps['DEADLINE'] = (_sec(offered.deadline), _sec(asked.deadline))
    if (
        offered.liveliness == LivelinessPolicy.AUTOMATIC
        and asked.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    ):
        gaps['LIVELINESS'] = ('AUTOMATIC', 'MANUAL_BY_TOPIC')
    if offered.liveliness_lease_duration > asked.liveliness_lease_duration:
        gaps['LIVELINESS LEASE'] = (
            _sec(offered.liveliness_lease_duration),
            _sec(asked.liveliness_lease_duration),
        )
    return gaps


def qos_text(qos_profile: QoSProfile) -> str:
    """The two policies that the lessons explain, such as 'RELIABLE/VOLATILE'."""
    return f'{qos_profile.reliability.name}/{qos_profile.durability.name}'


def hint_to_omit(policies: Iterable[str]) -> str:
    """What to try if a subscription requests policies that no publisher offers: one clause."""
    if 'LIVELINESS' in policies:
        return (
            'no publisher offers such a liveliness, which BEST_AVAILABLE requests, too, while'
            ' there is no publisher: set reliability and durability alone'
        )
    named = ' and '.join(sorted(policies)).lower()
    return f'the publisher offers no {named}, so leave that out of the profile'


def _sec(duration: Duration) -> str:
    seconds = duration.nanoseconds / 1e9
    return 'none' if seconds > 1e8 else f'{seconds:g} s'
