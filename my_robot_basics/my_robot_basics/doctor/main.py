"""The console script `topic_doctor`."""

import argparse
import os
import sys

from my_robot_basics.doctor.names import full_name
from my_robot_basics.language.speaking import language_here
from my_robot_basics.ros2 import completion, environment
from my_robot_basics.ros2.errors import CommandError

WELL, FAULT, USAGE, INTERRUPTED = 0, 1, 2, 130


def main(argv: list[str] | None = None) -> int:
    """Print why no message arrives on a topic, or why a service or an action does not answer.

    Returns 0 if all is well, 1 if a fault was found, 2 for wrong usage, 130 after Ctrl-C.
    """
    parser = argparse.ArgumentParser(
        'topic_doctor',
        description='Find out why no messages arrive on a topic, or why a service or an action'
        ' does not answer, and how to fix it. No service is ever called, and no goal sent.',
        epilog='Exit status: 0 when all is well, 1 when a fault was found, 2 on wrong usage.',
    )
    completion.add_argument(
        parser,
        'name',
        completer=completion.topic_and_service_names,
        help='of the topic, service or action, for example /kinematics/joint_states',
    )
    parser.add_argument(
        '--domains',
        action='store_true',
        help='look at the other ROS domains of this machine, too',
    )
    parser.add_argument(
        '--seconds',
        type=_seconds,
        default=6.0,
        help='how long to wait for messages, or for a callback to return, at most'
        ' (default: %(default)s)',
    )
    if '_ARGCOMPLETE' in os.environ:
        from argcomplete import autocomplete

        environment.enter()
        autocomplete(parser, exclude=['-h', '--help'])
    args = parser.parse_args(argv)
    environment.enter()
    try:
        name, domain_id = full_name(args.name), environment.domain_id()
    except (ValueError, CommandError) as error:
        parser.error(str(error))
    environment.print_joined_lesson()
    try:
        # imported late: rclpy is slow to import, and `--help` does not need it
        from my_robot_basics.doctor.diagnosing import diagnose
        from my_robot_basics.doctor.report import tell

        found = diagnose(
            name,
            domain_id=domain_id,
            other_domains=args.domains,
            seconds=args.seconds,
        )
    except KeyboardInterrupt:
        return INTERRUPTED
    except CommandError as error:
        print(error, file=sys.stderr)
        return USAGE
    print('\n\n'.join(tell(each, language_here()) for each in found))
    return FAULT if any(each.findings for each in found) else WELL


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0.0 < seconds <= 3600.0:
        raise ValueError
    return seconds


_seconds.__name__ = 'time in seconds'  # argparse: "invalid time in seconds value"


if __name__ == '__main__':
    sys.exit(main())
