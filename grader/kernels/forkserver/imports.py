"""What is imported before the first fork, so that no kernel has to: libraries, and no test.

Nothing here may start a thread, call rclpy.init or make a ZMQ context: a fork takes none along.
"""

import ctypes
import importlib
import sys

_BOTH = (
    'runpy',
    'ipykernel.kernelapp',
    'ipykernel.debugger',
    'IPython.core.completerlib',
    'IPython.core.display',
    'IPython.core.pylabtools',
    'IPython.extensions.storemagic',
    'IPython.display',
    'ipywidgets',
    'matplotlib.backends.backend_agg',
    'matplotlib.font_manager',
    'matplotlib.pyplot',
    'numpy',
    'rclpy',
    'rclpy.executors',
    'rclpy.node',
    'arm_interfaces.action',
    'arm_interfaces.srv',
    'builtin_interfaces.msg',
    'geometry_msgs.msg',
    'rcl_interfaces.msg',
    'rcl_interfaces.srv',
    'rosgraph_msgs.msg',
    'sensor_msgs.msg',
    'std_msgs.msg',
    'my_robot_basics.two_link_kinematics',
    'my_robot_basics.session.classroom',
)
_ROOMS = {
    'student': ('my_robot_basics.exchange.responder', 'my_robot_basics.exchange.probe'),
    'test': (
        'my_robot_basics.checks',
        'my_robot_basics.checks.clock',
        'my_robot_basics.graph.graphs',
        'my_robot_basics.feedback.hidden',
        'my_robot_basics.checks.latched',
        'my_robot_basics.checks.logs',
        'my_robot_basics.checks.sampling',
        'my_robot_basics.checks.pictures',
        'my_robot_basics.checks.predictions',
        'my_robot_basics.exchange.probe',
        'my_robot_basics.checks.recording',
        'my_robot_basics.checks.relays',
        'my_robot_basics.checks.seeds',
        'my_robot_basics.checks.delivery_experiment',
        'my_robot_basics.checks.stamps',
        'my_robot_basics.exchange.student',
        'my_robot_basics.checks.ik',
        'my_robot_basics.checks.topics',
    ),
}
"""What is imported for each room, beside what both need."""


def import_for(room: str) -> None:
    """Import what the kernels of the 'student' or the 'test' room need. Raises what fails."""
    for name in (*_BOTH, *_ROOMS[room]):
        importlib.import_module(name)
    _load_type_supports()


def _load_type_supports() -> None:
    """Load what ROS otherwise loads when the first node, publisher or subscription is made."""
    modules = [name for name in sys.modules if name.endswith(('.msg', '.srv'))]
    for package in sorted({name.partition('.')[0] for name in modules} | {'service_msgs'}):
        for kind in ('fastrtps_c', 'introspection_c'):
            ctypes.CDLL(f'lib{package}__rosidl_typesupport_{kind}.so')
    for name in modules:
        for thing in vars(sys.modules[name]).values():
            if hasattr(type(thing), '__import_type_support__'):
                type(thing).__import_type_support__()
