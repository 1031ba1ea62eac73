"""Nodes inside a notebook kernel: run, replace, stop; see the arm move.

Importing a name from here enters the classroom (see `classroom.enter`); importing the modules
`classroom` and `domain` does not, and does not load rclpy.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from my_robot_basics.live import classroom, domain

if TYPE_CHECKING:
    from my_robot_basics.live.arm import show_arm
    from my_robot_basics.live.branches import show_branches
    from my_robot_basics.live.camera import send_pictures
    from my_robot_basics.live.classroom import show_domain
    from my_robot_basics.live.doctor import why
    from my_robot_basics.live.exercise import reset, run_answer
    from my_robot_basics.live.follow import follow_arm
    from my_robot_basics.live.graph_picture import show_graph
    'show_queues',
