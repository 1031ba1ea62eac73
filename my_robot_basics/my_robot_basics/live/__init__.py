"""Nodes inside a notebook kernel: run, replace, stop; see the arm move.

Importing a name from here changes nothing in the process. A notebook's kernel is set up by the
first cell that names `live` (see `extension`), any other process by its first `run`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from my_robot_basics.session import classroom, domain
from my_robot_basics.session.classroom import show_domain

if TYPE_CHECKING:
    from my_robot_basics.live.arm import show_arm
    from my_robot_basics.live.branches import show_branches
    from my_robot_basics.live.camera import send_pictures
    from my_robot_basics.live.commands import run_commands
    from my_robot_basics.live.definition_view import show_definition
    from my_robot_basics.live.doctor import why
    from my_robot_basics.live.entry_points import add_entry_point
    from my_robot_basics.live.exercise import reset, run_answer
    from my_robot_basics.live.follow import follow_arm
    from my_robot_basics.live.goal_view import follow_goal
    from my_robot_basics.live.graph_picture import show_graph
    from my_robot_basics.live.node_file import show_workspace
    from my_robot_basics.live.packages import build_package, make_package, run_executable
    from my_robot_basics.live.qos_offers import show_offers
    from my_robot_basics.live.qos_pairs import measure_pairs
    from my_robot_basics.live.qos_pictures import show_lost_messages, show_qos_matrix
    from my_robot_basics.live.queue_picture import show_queues
    from my_robot_basics.live.runner import run, stop
    from my_robot_basics.live.service_picture import show_service
    from my_robot_basics.live.sliders import move_arm
    from my_robot_basics.live.target import drag_target
    from my_robot_basics.live.timeline import show_arrivals, show_deliveries
    from my_robot_basics.live.waiting import wait_until
    from my_robot_basics.live.workspace import make_workspace

__all__ = [
    'add_entry_point',
    'build_package',
    'classroom',
    'domain',
    'drag_target',
    'follow_arm',
    'follow_goal',
    'make_package',
    'make_workspace',
    'measure_pairs',
    'move_arm',
    'reset',
    'run',
    'run_answer',
    'run_commands',
    'run_executable',
    'send_pictures',
    'show_arm',
    'show_arrivals',
    'show_branches',
    'show_definition',
    'show_deliveries',
    'show_domain',
    'show_graph',
    'show_lost_messages',
    'show_offers',
    'show_qos_matrix',
    'show_queues',
    'show_service',
    'show_workspace',
    'stop',
    'wait_until',
    'why',
]

_MODULES = {
    'run': 'runner',
    'stop': 'runner',
    'reset': 'exercise',
    'run_answer': 'exercise',
    'run_commands': 'commands',
    'build_package': 'packages',
    'run_executable': 'packages',
    'make_package': 'packages',
    'show_arm': 'arm',
    'show_branches': 'branches',
    'show_arrivals': 'timeline',
    'show_deliveries': 'timeline',
    'drag_target': 'target',
    'move_arm': 'sliders',
    'follow_arm': 'follow',
    'follow_goal': 'goal_view',
    'show_graph': 'graph_picture',
    'show_queues': 'queue_picture',
    'show_service': 'service_picture',
    'show_offers': 'qos_offers',
    'measure_pairs': 'qos_pairs',
    'show_qos_matrix': 'qos_pictures',
    'show_lost_messages': 'qos_pictures',
    'send_pictures': 'camera',
    'why': 'doctor',
    'wait_until': 'waiting',
    'make_workspace': 'workspace',
    'add_entry_point': 'entry_points',
    'show_workspace': 'node_file',
    'show_definition': 'definition_view',
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(import_module(f'{__name__}.{_MODULES[name]}'), name)
