"""The camera in its own process: each picture is sent once, and errors are reported."""

import subprocess

import pytest
import rclpy
from my_robot_basics.live import run, send_pictures, stop, wait_until
from my_robot_basics.live.pictures import camera
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image


@pytest.fixture
def viewer():
    yield run(Node, 'viewer')
    stop()


def test_a_subscription_with_a_deep_queue_receives_all_pictures_in_order(viewer):
    numbers = []
    viewer.create_subscription(
        Image, '/camera', lambda p: numbers.append(int(p.header.frame_id)), QoSProfile(depth=12)
    )
    send_pictures(12, subscriptions=1)
    wait_until(lambda: len(numbers) == 12)
    assert numbers == [*range(1, 13)]


@pytest.mark.slow
def test_a_reliable_publisher_with_a_short_queue_loses_pictures(viewer):
    """Lesson 6: what RELIABLE is to send again must still be in the publisher's queue."""
    numbers = []
    viewer.create_subscription(
        Image, '/camera', lambda p: numbers.append(int(p.header.frame_id)), QoSProfile(depth=60)
    )
    send_pictures(60, subscriptions=1, depth=1)
    wait_until(lambda: 60 in numbers)
    assert 0 < len(numbers) < 60
    numbers.clear()
    send_pictures(60, subscriptions=1, depth=60)
    wait_until(lambda: 60 in numbers)
    assert numbers == [*range(1, 61)]


def test_a_camera_without_subscriptions_ends_with_an_error(monkeypatch):
    monkeypatch.setattr(camera, 'SUBSCRIPTIONS_SEC', 0.2)
    rclpy.try_shutdown()  # the camera begins in a process where nothing was initialised
    with pytest.raises(SystemExit, match=r'0 subscriptions in 0\.2 s'):
        camera.main(1, 1, 1)
    rclpy.try_shutdown()


def test_send_pictures_reports_the_error_of_the_camera_process(monkeypatch):
    ended = subprocess.CompletedProcess([], 1, stdout='', stderr='Traceback\nno memory')
    monkeypatch.setattr(camera.subprocess, 'run', lambda *args, **kwargs: ended)
    with pytest.raises(camera.NoPictures, match='saw the camera end with: no memory'):
        send_pictures(2, subscriptions=1)


def test_send_pictures_raises_an_error_if_the_camera_runs_too_long(monkeypatch, viewer):
    monkeypatch.setattr(camera, 'TIMEOUT_SEC', 0.1)
    with pytest.raises(camera.NoPictures, match=r'within 0\.1 s, saw it still run'):
        send_pictures(2, subscriptions=1)
