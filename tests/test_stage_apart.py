"""The stage of predictions is isolated: nothing that a student process sends arrives there.

Here one publishes and subscribes on every topic that DDS shows it.
"""

import asyncio
import json

import pytest

from grader.kernels.isolation import require_isolation
from grader.kernels.rooms import GradingRooms

pytestmark = pytest.mark.isolation

INTRUDER = """
import threading, time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

rclpy.init()
intruder, met, received = Node('intruder'), [], []

def intrude():
    while True:
        for name, types in intruder.get_topic_names_and_types():
            if types == ['std_msgs/msg/String'] and name not in met:
                met.append(name)
                intruder.create_subscription(String, name, lambda m: received.append(m.data), 1000)
                publishers.append(intruder.create_publisher(String, name, 1000))
        for publisher in publishers:
            for number in range(1, 6):
                publisher.publish(String(data=str(number)))
        rclpy.spin_once(intruder, timeout_sec=0.005)

publishers = [intruder.create_publisher(String, '/mine', 10)]
threading.Thread(target=intrude, daemon=True).start()
"""
LATE = """
import json, os, time
from my_robot_basics.checks.values.delivery_experiment import Stage, watchers

def sockets():
    links = [f'/proc/self/fd/{fd}' for fd in os.listdir('/proc/self/fd')]
    return sum(os.path.lexists(link) and os.readlink(link).startswith('socket:') for link in links)

arrived, before = [], sockets()
with watchers() as (senders, receivers):
    new = sockets() - before
    for _ in range(5):
        stage = Stage(senders, receivers)
        message = stage.publisher('/pose').publish()
        late = stage.subscription('/pose')
        time.sleep(0.2)
        arrived.append(late.received(message))
print(json.dumps([arrived, new]))
"""
MEETS = """
from my_robot_basics.checks import topic
print(topic('/mine').wait_for(timeout_sec=20.0).data)
"""


async def intruded():
    async with GradingRooms(isolated=require_isolation()) as rooms:
        assert (await rooms.run_student_cell(INTRUDER, timeout_sec=30.0)).ran_to_end
        meets = await rooms.run_check(MEETS)
        late = await rooms.run_check(LATE)
        met = await rooms.run_student_cell('print(met)', timeout_sec=30.0)
        return meets, late, met


def said(run):
    assert run.ran_to_end, run.error
    return ''.join(output.text for output in run.outputs).strip()


@pytest.mark.slow
def test_a_student_who_publishes_on_every_visible_topic_changes_no_prediction():
    meets, late, met = asyncio.run(intruded())
    assert said(meets) in {*'12345'}  # the intruder does reach a topic of the test room
    assert json.loads(said(late)) == [[False] * 5, 0]
    assert said(met) == "['/mine']"
