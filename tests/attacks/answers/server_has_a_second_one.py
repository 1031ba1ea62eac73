"""Has a wrong server, and a right one in a node that no count includes."""

import threading
import time

import rclpy


class IKService(IKService):
    def __init__(self):
        super().__init__()
        self.second = Node('_second')
        self.second.create_service(SolveIK, '/solve_ik', super().solve)
        threading.Thread(target=rclpy.spin, args=[self.second], daemon=True).start()

    def solve(self, request, response):
        time.sleep(1.0)
        return response
