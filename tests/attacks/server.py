"""An honest server; the code of an attack `server_…` is appended to it."""

import math

from my_robot_basics.two_link_kinematics import inverse_kinematics
from rclpy.node import Node

from arm_interfaces.srv import SolveIK


class IKService(Node):
    def __init__(self):
        super().__init__('ik_service')
        self.server = self.create_service(SolveIK, '/solve_ik', self.solve)

    def solve(self, request, response):
        try:
            poses = inverse_kinematics(request.target.x, request.target.y)
        except ValueError as error:
            response.message = str(error)
            return response
        response.reachable = True
        response.elbow_up = [math.radians(angle) for angle in poses['elbow_up']]
        response.elbow_down = [math.radians(angle) for angle in poses['elbow_down']]
        return response
