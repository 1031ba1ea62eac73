"""Subscribes with BEST_EFFORT, as for sensors: a lost message is not sent again."""

from five_hz import spin
from geometry_msgs.msg import Point
from ik_solver import IKSolver
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data


class IKSensorData(IKSolver):
    def __init__(self):
        Node.__init__(self, 'ik_solver_node')
        self.create_subscription(Point, '/target_point', self.solve, qos_profile_sensor_data)


def main():
    spin(IKSensorData)


if __name__ == '__main__':
    main()
