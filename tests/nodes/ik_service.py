"""Answers /solve_ik with both branches in radians, or says why not: the exercise's answer."""

import math

from five_hz import spin
from my_robot_basics.two_link_kinematics import inverse_kinematics
from rclpy.node import Node

from arm_interfaces.srv import SolveIK


class IKService(Node):
    def __init__(self, **kwargs):
        super().__init__('ik_service', **kwargs)
        self.service = self.create_service(SolveIK, '/solve_ik', self.solve)

    def solve(self, request, response):
        try:
            branches_deg = inverse_kinematics(request.target.x, request.target.y)
        except ValueError as error:
            response.message = str(error)
            return response
        response.reachable = True
        self.fill(response, branches_deg)
        return response

    def fill(self, response, branches_deg):
        response.elbow_up = [math.radians(angle) for angle in branches_deg['elbow_up']]
        response.elbow_down = [math.radians(angle) for angle in branches_deg['elbow_down']]


def main():
    spin(IKService)


if __name__ == '__main__':
    main()
