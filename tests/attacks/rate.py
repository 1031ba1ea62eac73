"""An honest publisher with a rate; the code of an attack `rate_…` is appended to it."""

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from sensor_msgs.msg import JointState


class AdjustablePublisher(Node):
    def __init__(self, **options):
        super().__init__('adjustable_publisher', **options)
        self.poses = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.declare_parameter('rate_hz', 5.0)
        self.timer = self.create_timer(0.2, self.publish)
        self.add_on_set_parameters_callback(self.judge)

    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz':
                if not 1.0 <= parameter.value <= 50.0:
                    return SetParametersResult(successful=False, reason='use 1 to 50 Hz')
                self.change(parameter.value)
        return SetParametersResult(successful=True)

    def change(self, rate_hz):
        self.destroy_timer(self.timer)
        self.timer = self.create_timer(1.0 / rate_hz, self.publish)

    def publish(self):
        self.poses.publish(JointState(name=['joint1', 'joint2'], position=[0.5, -1.0]))
