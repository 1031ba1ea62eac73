"""Environment variables that the command sets for itself and its children, if they are unset."""

import os
import sys

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.session import lessons, overlays, sourced_workspaces
from my_robot_basics.session.classroom import FAST_DISCOVERY, HIGHEST_DOMAIN

_joined: lessons.RunningLesson | None = None


def enter() -> None:
    """Set the variables that are not set yet.

    In a notebook cell, all of them are inherited from the kernel.
    """
    defaults = {
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'FASTRTPS_DEFAULT_PROFILES_FILE': str(FAST_DISCOVERY),
    }
    for name, value in defaults.items():
        if not os.environ.get(name):
            os.environ[name] = value
    if not os.environ.get('ROS_DOMAIN_ID'):
        os.environ['ROS_DOMAIN_ID'] = _domain_to_join()
    _put_last('AMENT_PREFIX_PATH', sys.prefix)  # a workspace that was sourced comes first
    if '_ARGCOMPLETE' not in os.environ:
        for sentence in sourced_workspaces.faults(os.environ):
            overlays.say(sentence)


def _domain_to_join() -> str:
    """Return the domain for a shell without one: of the lesson that started last, or ROS's 0."""
    global _joined
    if running := lessons.running():
        _joined = running[-1]
    return str(_joined.domain_id if _joined else 0)


def print_joined_lesson() -> None:
    """Print to stderr which lesson was joined, unless ROS_DOMAIN_ID was set in the shell."""
    if _joined and '_ARGCOMPLETE' not in os.environ:
        told = (
            f'joined the lesson {_joined.name}, which started last: '
            f'ROS_DOMAIN_ID={_joined.domain_id}'
        )
        print(in_language_here(told), file=sys.stderr)


def domain_id() -> int:
    """Return the environment's ROS domain ID; raises CommandError if it is invalid."""
    text = os.environ['ROS_DOMAIN_ID']
    if text.isascii() and text.isdigit() and int(text) <= HIGHEST_DOMAIN:
        return int(text)
    raise CommandError(
        f'ROS_DOMAIN_ID is {text!r}, expected a number from 0 to {HIGHEST_DOMAIN}: '
        'correct it, or unset it'
    )


def is_localhost_only() -> bool:
    """Whether nodes on other machines cannot be discovered."""
    discovery_range = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE')
    return discovery_range == 'LOCALHOST' and not os.environ.get('ROS_STATIC_PEERS')


def _put_last(name: str, folder: str) -> None:
    folders = [f for f in os.environ.get(name, '').split(os.pathsep) if f]
    if folder not in folders:
        os.environ[name] = os.pathsep.join([*folders, folder])
