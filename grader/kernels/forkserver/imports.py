"""What is imported before the first fork, so that no kernel has to: libraries, but no tests.

Nothing here may start a thread, call rclpy.init or make a ZMQ context: a fork does not copy them.
"""

import ctypes
import importlib
import pkgutil
import sys

_BOTH = (
    'argcomplete',
    'faulthandler',
    'runpy',
    'ipykernel.kernelapp',
    'ipykernel.debugger',
    'IPython.core.completerlib',
    'IPython.core.debugger',
    'IPython.core.display',
    'IPython.core.logger',
    'IPython.core.oinspect',
    'IPython.core.pylabtools',
    'IPython.extensions.storemagic',
    'IPython.display',
    'IPython.utils.wildcard',
    'numpy.random',  # each kernel seeds it again, see `_forget`
    'pygments.formatters.terminal256',
    'rclpy',
    'rclpy.action',
    'rclpy.executors',
    'rclpy.node',
    'rclpy.wait_for_message',
    'stack_data',
    'tornado.platform.asyncio',
    'traitlets.config.argcomplete_config',
    'arm_interfaces.action',
    'arm_interfaces.srv',
    'builtin_interfaces.msg',
    'geometry_msgs.msg',
    'rcl_interfaces.msg',
    'rcl_interfaces.srv',
    'rosgraph_msgs.msg',
    'sensor_msgs.msg',
    'std_msgs.msg',
    'std_srvs.srv',
    'my_robot_basics.two_link_kinematics',
    'my_robot_basics.session.classroom',
    'my_robot_basics.live.extension',
)
_ROOMS = {
    'student': (
        'my_robot_basics.doctor',
        'my_robot_basics.drawing',
        'my_robot_basics.exchange',
        'my_robot_basics.live',
        'my_robot_basics.session',
    ),
    'test': (
        'my_robot_basics.checks',
        'my_robot_basics.exchange',
        'my_robot_basics.feedback',
        'my_robot_basics.graph',
    ),
}
"""Packages imported for one room only, with all their modules, in addition to _BOTH."""
_PICTURES = (
    'matplotlib.backends.backend_agg',
    'matplotlib.figure',
    'matplotlib.font_manager',
)
"""A third of the import time, and most kernels draw nothing."""


def import_for(room: str) -> None:
    """Import what the kernels of the 'student' or the 'test' room need. Raises what fails."""
    for name in _BOTH:
        importlib.import_module(name)
    for name in _ROOMS[room]:
        _import_all_of(name)
    _load_type_supports()


def import_when_idle() -> None:
    """Import what only some kernels need. Raises what fails."""
    for name in _PICTURES:
        importlib.import_module(name)


def _import_all_of(name: str) -> None:
    """Import a package and its modules, except programs; a written list would become outdated."""
    package = importlib.import_module(name)
    for module in pkgutil.iter_modules(package.__path__, f'{name}.'):
        if module.ispkg:
            _import_all_of(module.name)
        elif not module.name.endswith('.__main__'):
            importlib.import_module(module.name)


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
