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
from typing import Any

from my_robot_basics.session import classroom, domain
from my_robot_basics.session.classroom import show_domain

LAYERS = ('output', 'patches', 'packages', 'nodes', 'pictures', 'unknown_robot', 'extension')
"""The parts, lowest layer first."""
_HOMES = {
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

__all__ = [*_HOMES, 'classroom', 'domain', 'show_domain']


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(import_module(f'{__name__}.{_HOMES[name]}'), name)
