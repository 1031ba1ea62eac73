"""QoS profiles from the arguments that `arguments.add_qos` adds."""

import argparse
from collections.abc import Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import (
    QoSDurabilityPolicy,
    QoSHistoryPolicy,
    QoSLivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    QoSReliabilityPolicy,
)

_POLICIES = {
    'history': QoSHistoryPolicy,
    'durability': QoSDurabilityPolicy,
    'reliability': QoSReliabilityPolicy,
    'liveliness': QoSLivelinessPolicy,
}


def preset(args: argparse.Namespace) -> QoSProfile:
    """Return the profile that `--qos-profile` names."""
    return QoSPresetProfiles.get_from_short_key(args.qos_profile)


def has_overrides(args: argparse.Namespace) -> bool:
    """Whether the arguments set any single policy."""
    names = [*_POLICIES, 'depth', 'liveliness_lease_duration_seconds']
    return any(getattr(args, f'qos_{name}') is not None for name in names)


def profile(args: argparse.Namespace) -> QoSProfile:
    """Return the preset profile, overridden by the single policies."""
    made = preset(args)
    for name, policy in _POLICIES.items():
        if (short_key := getattr(args, f'qos_{name}')) is not None:
            setattr(made, name, policy.get_from_short_key(short_key))
    lease_sec = args.qos_liveliness_lease_duration_seconds
    if lease_sec is not None and lease_sec > 0:
        made.liveliness_lease_duration = Duration(seconds=lease_sec)
    if args.qos_depth is not None and args.qos_depth > 0:
        made.depth = args.qos_depth
    elif made.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL and made.depth == 0:
        made.depth = 1  # messages for late subscribers need a place in the queue
    return made


def for_publishers(publishers: Sequence[Any], args: argparse.Namespace) -> QoSProfile:
    """Return the profile of the arguments, or one compatible with all publishers.

    Publishers are given as TopicEndpointInfo. Prints a note if some of them offer a stronger
    policy than the profile requests.
    """
    if has_overrides(args):
        return profile(args)
    made = preset(args)
    policies = {
        'reliability': (QoSReliabilityPolicy.RELIABLE, QoSReliabilityPolicy.BEST_EFFORT),
        'durability': (QoSDurabilityPolicy.TRANSIENT_LOCAL, QoSDurabilityPolicy.VOLATILE),
    }
    for name, (stricter, looser) in policies.items() if publishers else ():
        strict = [getattr(each.qos_profile, name) == stricter for each in publishers]
        if any(strict) and not all(strict):
            print(
                f'Some, but not all, publishers are offering {_full(stricter)}. Falling back '
                f'to {_full(looser)} as it will connect to all publishers'
            )
        setattr(made, name, stricter if all(strict) else looser)
    return made


def _full(policy: Any) -> str:
    return f'QoS{type(policy).__name__}.{policy.name}'
