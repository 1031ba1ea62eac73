"""What the programs of `forked.py` find loaded: no thread of Python's is started, no node made."""

import argcomplete  # noqa: F401
import numpy  # noqa: F401
import rclpy
import yaml  # noqa: F401
from geometry_msgs.msg import Point
from my_robot_basics.ros2 import main  # noqa: F401
from rcl_interfaces.msg import Log, ParameterEvent
from rclpy import executors, parameter_service  # noqa: F401
from rclpy.type_support import check_for_type_support
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

rclpy.get_rmw_implementation_identifier()
for message in (Clock, JointState, Log, ParameterEvent, Point, String):
    check_for_type_support(message)
