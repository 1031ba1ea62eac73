"""Nodes inside a notebook kernel: run, replace, stop; see the arm move.

Importing a name from here changes nothing in the process. A notebook's kernel is set up by the
first cell that names `live` (see `extension`), any other process by its first `run`.

The code is in packages; each imports only from those before it in LAYERS:

- `output`: What a cell shows: its panel, the ROS logger's lines, exceptions of callbacks.
- `patches`: What this process changes about rclpy of Jazzy, and about its waits.
- `packages`: A ROS package of the student's: its workspace, its build, its processes.
- `nodes`: Nodes of a notebook: started, replaced and stopped, the answer's among them.
- `pictures`: Pictures of the arm, of the graph, and of what happens to messages.
- `unknown_robot`: A robot that the student has not seen before, in a lesson's locked cell.
- `extension`: What each notebook kernel loads: it sets the kernel up.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from my_robot_basics.session import classroom, domain
from my_robot_basics.session.classroom import show_domain

if TYPE_CHECKING:
    from my_robot_basics.live.nodes.exercise import reset, run_answer
    from my_robot_basics.live.nodes.runner import run, stop
    from my_robot_basics.live.output.waiting import wait_until
    from my_robot_basics.live.packages.commands import run_commands
    from my_robot_basics.live.packages.entry_points import add_entry_point
    from my_robot_basics.live.packages.node_file import show_workspace
    from my_robot_basics.live.packages.packages import build_package, make_package, run_executable
    from my_robot_basics.live.packages.workspace import make_workspace
    from my_robot_basics.live.pictures.arm import show_arm
    from my_robot_basics.live.pictures.branches import show_branches
    from my_robot_basics.live.pictures.camera import send_pictures
    from my_robot_basics.live.pictures.definition_view import show_definition
    from my_robot_basics.live.pictures.doctor import why
    from my_robot_basics.live.pictures.follow import follow_arm
    from my_robot_basics.live.pictures.goal_view import follow_goal
    from my_robot_basics.live.pictures.graph_picture import show_graph
    from my_robot_basics.live.pictures.qos_offers import show_offers
    from my_robot_basics.live.pictures.qos_pairs import measure_pairs
    from my_robot_basics.live.pictures.qos_pictures import show_lost_messages, show_qos_matrix
    from my_robot_basics.live.pictures.queue_picture import show_queues
    from my_robot_basics.live.pictures.service_picture import show_service
    from my_robot_basics.live.pictures.sliders import move_arm
    from my_robot_basics.live.pictures.target import drag_target
    from my_robot_basics.live.pictures.timeline import show_arrivals, show_deliveries

LAYERS = ('output', 'patches', 'packages', 'nodes', 'pictures', 'unknown_robot', 'extension')
"""The parts, lowest layer first."""
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
    'run': 'nodes.runner',
    'stop': 'nodes.runner',
    'reset': 'nodes.exercise',
    'run_answer': 'nodes.exercise',
    'run_commands': 'packages.commands',
    'build_package': 'packages.packages',
    'run_executable': 'packages.packages',
    'make_package': 'packages.packages',
    'show_arm': 'pictures.arm',
    'show_branches': 'pictures.branches',
    'show_arrivals': 'pictures.timeline',
    'show_deliveries': 'pictures.timeline',
    'drag_target': 'pictures.target',
    'move_arm': 'pictures.sliders',
    'follow_arm': 'pictures.follow',
    'follow_goal': 'pictures.goal_view',
    'show_graph': 'pictures.graph_picture',
    'show_queues': 'pictures.queue_picture',
    'show_service': 'pictures.service_picture',
    'show_offers': 'pictures.qos_offers',
    'measure_pairs': 'pictures.qos_pairs',
    'show_qos_matrix': 'pictures.qos_pictures',
    'show_lost_messages': 'pictures.qos_pictures',
    'send_pictures': 'pictures.camera',
    'why': 'pictures.doctor',
    'wait_until': 'output.waiting',
    'make_workspace': 'packages.workspace',
    'add_entry_point': 'packages.entry_points',
    'show_workspace': 'packages.node_file',
    'show_definition': 'pictures.definition_view',
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(import_module(f'{__name__}.{_MODULES[name]}'), name)
