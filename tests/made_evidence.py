"""Evidence made for tests: what the doctor would have seen of a topic and of a service."""

import dataclasses
import time

from my_robot_basics.doctor.callback import Callback
from my_robot_basics.doctor.evidence import Endpoint, Evidence, NodeState, ReceivedMessage
from my_robot_basics.doctor.served_evidence import ServiceEvidence
from rclpy.duration import Duration
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

TOPIC = '/kinematics/joint_states'


def infinite(profile):
    """Make unset durations infinite, as the graph reports them."""
    for name in 'deadline', 'liveliness_lease_duration':
        if getattr(profile, name).nanoseconds == 0:
            setattr(profile, name, Duration(nanoseconds=2**63 - 1))
    return profile


def end(kind, node_name, *, topic_name=TOPIC, type_name='sensor_msgs/msg/JointState', depth=None):
    return Endpoint(
        kind=kind,
        node_name=node_name,
        name=topic_name,
        type_name=type_name,
        qos_profile=infinite(QoSProfile(depth=depth or 10)),
        depth=depth,
    )


def healthy(*, rate_hz=5.0, number=10, position=(0.4, -1.1), names=('joint1', 'joint2')):
    start_sec = time.time()
    received = []
    for i in range(number):
        message = JointState(name=list(names), position=list(position))
        sent_sec = start_sec + i / rate_hz
        message.header.stamp.sec = int(sent_sec)
        message.header.stamp.nanosec = int(sent_sec % 1 * 1e9)
        received.append(ReceivedMessage(message=message, sent_sec=sent_sec))
    return Evidence(
        name=TOPIC,
        endpoints=(end('publisher', '/talker'), end('subscription', '/listener')),
        nodes={'/talker': NodeState(answers=True), '/listener': NodeState(answers=True)},
        received=tuple(received),
        listened_sec=number / rate_hz,
        start_sec=start_sec,
    )


def replaced(evidence=None, **changes):
    return dataclasses.replace(evidence or healthy(), **changes)


SILENT = {'received': (), 'listened_sec': 6.0}
NAME = '/close_gripper'
GRIPPER, WAVER = '/gripper', '/waver'


def service_end(kind, node_name, *, name=NAME, type_name='std_srvs/srv/SetBool'):
    return Endpoint(kind=kind, node_name=node_name, name=name, type_name=type_name)


SERVES, ASKS = service_end('server', GRIPPER), service_end('client', WAVER)


def healthy_service(**changes):
    evidence = ServiceEvidence(
        name=NAME,
        endpoints=(SERVES, ASKS),
        nodes={GRIPPER: NodeState(answers=True), WAVER: NodeState(answers=True)},
        looked_sec=0.1,
    )
    return dataclasses.replace(evidence, **changes)


def silent(node_name, **changes):
    nodes = healthy_service().nodes | {node_name: NodeState(answers=False)}
    return healthy_service(nodes=nodes, looked_sec=3.0, **changes)


def callback(node_name, name, **changes):
    return Callback(node_name=node_name, name=name, line='line 4: …', seconds=5.9, **changes)


DEADLOCK = callback(
    WAVER, 'ask', waits_in='call', waits_for=NAME, keeps='executor', holds=(WAVER,)
)
