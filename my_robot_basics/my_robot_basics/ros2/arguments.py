"""Arguments that several verbs share, and the types of their values.

The choices of QoS policies are written down here, so that `--help` and error messages need no
import of rclpy; a test compares them with rclpy's.
"""

import argparse
import math

PROFILES = (
    'unknown',
    'default',
    'system_default',
    'sensor_data',
    'services_default',
    'parameters',
    'parameter_events',
    'action_status_default',
    'best_available',
)
POLICIES = {
    'history': ('system_default', 'keep_last', 'keep_all', 'unknown'),
    'reliability': (
        'system_default',
        'reliable',
        'best_effort',
        'unknown',
        'best_available',
    ),
    'durability': (
        'system_default',
        'transient_local',
        'volatile',
        'unknown',
        'best_available',
    ),
    'liveliness': (
        'system_default',
        'automatic',
        'manual_by_topic',
        'unknown',
        'best_available',
    ),
}
MOST = 2**31 - 1
"""The largest accepted queue depth, count, or time in seconds."""


def positive_int(text: str) -> int:
    """Parse a whole number from 1."""
    return _int_from(1, text, 'value must be a positive integer')


def unsigned_int(text: str) -> int:
    """Parse a whole number from 0."""
    return _int_from(0, text, 'value must be non-negative integer')


def any_int(text: str) -> int:
    """Parse a whole number."""
    return _int_from(-MOST, text, f'value must be an integer, {MOST} at most')


def positive_float(text: str) -> float:
    """Parse a number above 0: seconds, or a rate in Hz."""
    number = any_float(text)
    if number <= 0.0:
        raise argparse.ArgumentTypeError('Value must be positive')
    if not 1.0 / MOST <= number <= MOST:
        raise argparse.ArgumentTypeError(f'Value must lie between 1/{MOST} and {MOST}')
    return number


def any_float(text: str) -> float:
    """Parse a finite number."""
    try:
        number = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError('Expects a floating point number') from None
    if not math.isfinite(number) or abs(number) > MOST:
        raise argparse.ArgumentTypeError(f'Expects a finite number, {MOST} at most')
    return number


def _int_from(lowest: int, text: str, complaint: str) -> int:
    try:
        number = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(complaint) from None
    if not lowest <= number <= MOST:
        raise argparse.ArgumentTypeError(complaint)
    return number


def add_discovery(parser: argparse.ArgumentParser, *, daemon: bool = True) -> None:
    """Add the arguments of a verb that uses the graph."""
    parser.add_argument(
        '--spin-time',
        type=any_float,
        help='Spin time in seconds to wait for discovery (default: until the graph has settled)',
    )
    parser.add_argument(
        '-s', '--use-sim-time', action='store_true', help='Enable ROS simulation time'
    )
    if daemon:
        parser.add_argument(
            '--no-daemon',
            action='store_true',
            help='Do not spawn nor use an already running daemon (there never is one here)',
        )


def add_hidden_topics(parser: argparse.ArgumentParser) -> None:
    """Add the option of `ros2 topic` to a verb, too: it is allowed before and after the verb."""
    _add_hidden(parser, 'topics')


def add_hidden_services(parser: argparse.ArgumentParser) -> None:
    """Add the option of `ros2 service` to a verb, too: it is allowed before and after the verb."""
    _add_hidden(parser, 'services')


def _add_hidden(parser: argparse.ArgumentParser, what: str) -> None:
    parser.add_argument(
        f'--include-hidden-{what}',
        action='store_true',
        default=argparse.SUPPRESS,  # else it would overwrite the option before the verb
        help=f'Consider hidden {what} as well',
    )


def add_qos(parser: argparse.ArgumentParser, verb: str, default_profile: str) -> None:
    """Add the arguments that make up a QoS profile to publish or subscribe with."""
    parser.add_argument(
        '--qos-profile',
        choices=PROFILES,
        default=default_profile,
        help=f'Quality of service preset profile to {verb} with (default: {default_profile})',
    )
    parser.add_argument(
        '--qos-depth',
        metavar='N',
        type=any_int,
        help=f'Queue size setting to {verb} with (overrides depth value of --qos-profile option)',
    )
    for policy, choices in POLICIES.items():
        parser.add_argument(
            f'--qos-{policy}',
            choices=choices,
            help=f'Quality of service {policy} setting to {verb} with '
            f'(overrides {policy} value of --qos-profile option)',
        )
    parser.add_argument(
        '--qos-liveliness-lease-duration-seconds',
        type=any_float,
        help=f'Quality of service liveliness lease duration setting to {verb} with '
        '(overrides liveliness lease duration value of --qos-profile option)',
    )
