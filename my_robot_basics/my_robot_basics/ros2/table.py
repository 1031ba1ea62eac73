"""The table of commands and verbs: a new verb is a file in `verbs/` and a word here."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """A command, the first word after `ros2`."""

    description: str
    verbs: tuple[str, ...] = ()
    """Each is `verbs/<command>_<verb>.py`; a command without verbs is `verbs/<command>.py`."""
    elsewhere: tuple[str, ...] = ()
    """Verbs that only ros2cli has."""
    hidden_flag: str = ''
    """An option of the command itself, which applies to all its verbs."""


COMMANDS = {
    'action': Command(
        'Various action related sub-commands', verbs=('info', 'list', 'send_goal', 'type')
    ),
    'interface': Command(
        'Show information about ROS interfaces',
        verbs=('list', 'package', 'packages', 'proto', 'show'),
    ),
    'node': Command('Various node related sub-commands', verbs=('info', 'list')),
    'param': Command(
        'Various param related sub-commands',
        verbs=('delete', 'describe', 'dump', 'get', 'list', 'load', 'set'),
    ),
    'pkg': Command(
        'Various package related sub-commands',
        verbs=('create', 'executables', 'list', 'prefix'),
        elsewhere=('xml',),
    ),
    'run': Command('Run a package specific executable'),
    'service': Command(
        'Various service related sub-commands',
        verbs=('call', 'find', 'info', 'list', 'type'),
        elsewhere=('echo',),
        hidden_flag='--include-hidden-services',
    ),
    'topic': Command(
        'Various topic related sub-commands',
        verbs=('bw', 'echo', 'find', 'hz', 'info', 'list', 'pub', 'type'),
        elsewhere=('delay',),
        hidden_flag='--include-hidden-topics',
    ),
}

ELSEWHERE = (
    *('bag', 'component', 'daemon', 'doctor', 'extension_points', 'extensions'),
    *('launch', 'lifecycle', 'multicast', 'security', 'test', 'trace', 'wtf'),
)
"""Commands that only a ROS 2 installation has."""
