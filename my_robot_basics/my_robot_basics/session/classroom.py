"""What a process needs before `rclpy.init` to take part in a lesson.

Imports neither rclpy nor anything else that is slow.
"""

import os
import sys
from pathlib import Path

from my_robot_basics.session import kernel, lessons
from my_robot_basics.session.domain import Claim, claim
from my_robot_basics.session.errors import BadDomain, tell

HIGHEST_DOMAIN = 232
PACKAGE = Path(__file__).parents[2]
"""The folder of this package's package.xml, as the course installs it."""
FAST_DISCOVERY = Path(__file__).with_name('fast_discovery.xml')
"""Fast DDS profile with which nodes of two processes discover each other within a second."""

_claim: Claim | None = None
_domain_id: int | None = None


def enter() -> int:
    """Set the environment of a lesson, once, and return the ROS domain ID.

    Discovery is limited to this machine, and fast; logs go to stdout, line by line and without
    colours; ROS resources and commands are found in this Python's prefix; and the process has
    a ROS domain of its own, or the one that MY_ROBOT_BASICS_DOMAIN_ID names. It takes effect
    for contexts that are initialised afterwards. A notebook's kernel also announces its lesson
    to terminals. Raises NoFreeDomain or BadDomain.
    """
    global _claim, _domain_id
    if _domain_id is None:
        given = os.environ.get('MY_ROBOT_BASICS_DOMAIN_ID')
        if given:
            _domain_id = _checked(given)
        else:
            _claim = claim()
            _domain_id = _claim.domain_id
        _set_environment(_domain_id)
        if kernel.shell() and not in_grading_room():
            lessons.announce(_domain_id)
    return _domain_id


def show_domain() -> None:
    """Print the line that lets a terminal join this lesson."""
    tell(f'In a terminal, join this lesson: export ROS_DOMAIN_ID={enter()}')


def workspace() -> Path:
    """Return the colcon workspace: MY_ROBOT_BASICS_WORKSPACE, or else the course's `ros_ws/`."""
    return Path(os.environ.get('MY_ROBOT_BASICS_WORKSPACE') or PACKAGE.parent / 'ros_ws')


def in_grading_room() -> bool:
    """Whether the grader has started this process."""
    return 'MY_ROBOT_BASICS_ROOM' in os.environ


def in_students_room() -> bool:
    """Whether this process runs a student's code, for the grader or for *Validate*."""
    return os.environ.get('MY_ROBOT_BASICS_ROOM') == 'student'


def _checked(given: str) -> int:
    if given.isascii() and given.isdigit() and int(given) <= HIGHEST_DOMAIN:
        return int(given)
    raise BadDomain(
        f'MY_ROBOT_BASICS_DOMAIN_ID is {given!r}, expected a number from 0 to {HIGHEST_DOMAIN}: '
        'correct it, or unset it to get a free domain'
    )


def _set_environment(domain_id: int) -> None:
    network = {
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'FASTRTPS_DEFAULT_PROFILES_FILE': str(FAST_DISCOVERY),
    }
    for name, value in network.items():
        # the grader sets up the network of its rooms: keep the values that it has set
        if not (in_grading_room() and os.environ.get(name)):
            os.environ[name] = value
    os.environ['RCUTILS_LOGGING_USE_STDOUT'] = '1'
    os.environ['RCUTILS_LOGGING_BUFFERED_STREAM'] = '1'
    os.environ['RCUTILS_COLORIZED_OUTPUT'] = '0'
    # ipykernel asks for colors (FORCE_COLOR), and from 3.13 Python obeys, even into a pipe
    os.environ['PYTHON_COLORS'] = '0'
    os.environ['ROS_DOMAIN_ID'] = str(domain_id)
    os.environ['ROS_WS'] = str(workspace())
    if ' ' in sys.prefix:
        # colcon's setup.bash fails if its Python's path has a space; any Python will do
        os.environ['COLCON_PYTHON_EXECUTABLE'] = str(Path(sys.executable).resolve())
    _put_first('AMENT_PREFIX_PATH', sys.prefix)
    _put_first('PATH', str(Path(sys.prefix, 'bin')))  # for commands in a cell, such as `!colcon`


def _put_first(name: str, folder: str) -> None:
    folders = [f for f in os.environ.get(name, '').split(os.pathsep) if f]
    if folder not in folders:
        os.environ[name] = os.pathsep.join([folder, *folders])
