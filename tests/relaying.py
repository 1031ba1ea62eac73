"""A relay node between two topics, and its checks, for tests of `relay`."""

import itertools

from my_robot_basics.checks import relay
from nodes.running import imported
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import String

monitor = imported('joint_state_monitor')
numbers = itertools.count()

joint_states = relay('/sensor/joint_states', to='/monitor/joint_states')
arm_description = relay('/arm_description', to='/monitor/arm_description')


def description():
    return String(data=f'an arm with {next(numbers)} joints')


def pose():
    return JointState(name=['joint1'], position=[float(next(numbers) % 1000 + 1)])


def check_delivery():
    joint_states.assert_carries(pose, qos_profile=qos_profile_sensor_data)


def check_late_joiner():
    arm_description.assert_carries_latched(description, times=3)


class Counts(monitor.JointStateMonitor):
    """Each callback keeps its messages; `chosen` decides which of them are published."""

    def changed(self, publish):
        received = []

        def receive(message):
            received.append(message)
            for each in self.chosen(received):
                publish(each)

        return receive
