"""What a lesson states in passing and does not show: each fact is seen here."""

import subprocess
import sys

from my_robot_basics.checks.watcher import Watcher
from my_robot_basics.ros2.verbs.topic_hz import Rate
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from std_msgs.msg import String

EXECUTORS = """
import rclpy
from my_robot_basics.live import run, stop
from rclpy.node import Node

print(type(run(Node, 'spun').executor).__name__, type(rclpy.get_global_executor()).__name__)
stop()
"""


def test_run_and_spin_use_a_single_threaded_executor():
    """Lesson 4; `rclpy.spin` takes the global one where it is given none."""
    done = subprocess.run(
        [sys.executable, '-c', EXECUTORS], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1].split()[-2:] == ['SingleThreadedExecutor'] * 2


def test_a_message_does_not_say_who_sent_it():
    """Lesson 1; nor does what rclpy tells a callback beside the message."""
    told = []
    with Watcher() as watcher:
        publisher = watcher.node.create_publisher(String, '/_said', 1)
        watcher.node.create_subscription(String, '/_said', lambda _, info: told.append(info), 1)
        watcher.spin_until(lambda: publisher.get_subscription_count() > 0, timeout_sec=10.0)
        publisher.publish(String(data='elbow up'))
        assert watcher.spin_until(lambda: bool(told), timeout_sec=10.0)
    words = [*String.get_fields_and_field_types(), *told[0]]
    assert words[0] == 'data'
    assert all('timestamp' in word or 'sequence_number' in word for word in words[1:]), words


def test_the_window_of_hz_counts_gaps(capsys):
    """Lesson 5; four messages, half a second apart, have three gaps."""
    now_nsec = 10**9
    rate = Rate(lambda: now_nsec, window_size=10)
    for _ in range(4):
        rate.arrival()
        now_nsec += 5 * 10**8
    assert 'average rate: 2.000' in (said := capsys.readouterr().out)
    assert said.endswith('window: 3\n')


def test_an_action_is_made_with_rclpy_action():
    """Lesson 7; an action can be cancelled, and tells of its progress."""
    assert callable(ClientGoalHandle.cancel_goal_async)
    assert callable(ServerGoalHandle.publish_feedback)
