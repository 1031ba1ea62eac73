"""Publishes nothing, and subscribes by DDS to a topic whose name makes rclpy raise."""

from my_robot_basics.graph.rmw import LatchedSubscription


class KinematicsPublisher(KinematicsPublisher):
    def __init__(self):
        super().__init__()
        self.destroy_timer(self.timer)
        self.kept = LatchedSubscription(
            self, 'rt/no name!', package='std_msgs', message_name='Empty'
        )
