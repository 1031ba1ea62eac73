"""Logs both solutions for each target, and warns of those out of reach: the exercise's answer."""

from five_hz import spin
from geometry_msgs.msg import Point
from my_robot_basics.two_link_kinematics import inverse_kinematics
from rclpy.node import Node


class IKSolver(Node):
    def __init__(self):
        super().__init__('ik_solver_node')
        self.create_subscription(Point, '/target_point', self.solve, 10)

    def solve(self, point):
        try:
            solutions = inverse_kinematics(point.x, point.y)
        except ValueError as error:
            self.get_logger().warning(str(error))
            return
        self.report(solutions)

    def report(self, solutions):
        for name, (theta1_deg, theta2_deg) in solutions.items():
            self.get_logger().info(f'IK {name}: θ1={theta1_deg:.2f}°, θ2={theta2_deg:.2f}°')


def main():
    spin(IKSolver)


if __name__ == '__main__':
    main()
