"""A camera in a process of its own that sends pictures faster than subscriptions take them.

`send_pictures` runs `python -m my_robot_basics.live.pictures.camera COUNT SUBSCRIPTIONS DEPTH`.
"""

import array
import os
import subprocess
import sys
import time

from my_robot_basics.session import classroom
from my_robot_basics.session.errors import LiveError

TOPIC_NAME = '/camera'
WIDTH, HEIGHT = 480, 320
"""A picture has 0.46 MB: a best-effort subscription receives some of them and loses others."""
SUBSCRIPTIONS_SEC = 10.0
ARRIVED_SEC = 10.0
TIMEOUT_SEC = 30.0


class NoPictures(LiveError):
    """The camera did not send all pictures."""


def send_pictures(count: int, *, subscriptions: int, depth: int | None = None) -> None:
    """Publish `count` pictures (0.46 MB each) on /camera, once it has `subscriptions` of them.

    They are sent RELIABLE, without a pause, by a separate process, which has ended when this
    returns. The publisher's queue holds `depth` pictures, by default all. A picture's frame_id is
    its number, from 1. Raises NoPictures.
    """
    numbers = count, subscriptions, count if depth is None else depth
    command = [sys.executable, '-m', __name__, *map(str, numbers)]
    here = {**os.environ, 'MY_ROBOT_BASICS_DOMAIN_ID': str(classroom.enter())}
    try:
        done = subprocess.run(
            command, env=here, capture_output=True, text=True, timeout=TIMEOUT_SEC
        )
    except subprocess.TimeoutExpired:
        raise NoPictures(
            f'expected the camera to end within {TIMEOUT_SEC:g} s, saw it still run: '
            'close what keeps this machine busy, and run the cell again'
        ) from None
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ['nothing'])[-1]
        raise NoPictures(
            f'expected {subscriptions} subscriptions on {TOPIC_NAME} and {count} pictures, saw'
            f' the camera end with: {said}'
        )


def main(count: int, subscriptions: int, depth: int) -> None:
    """Run the camera's node until all pictures are sent."""
    classroom.enter()
    # imported only now, after `enter` has set the environment for rclpy
    import rclpy
    from rclpy.duration import Duration
    from rclpy.qos import QoSProfile
    from sensor_msgs.msg import Image

    rclpy.init()
    node = rclpy.create_node('camera')
    publisher = node.create_publisher(Image, TOPIC_NAME, QoSProfile(depth=depth))
    picture = Image(width=WIDTH, height=HEIGHT, step=3 * WIDTH, encoding='rgb8')
    picture.data = array.array('B', bytes(3 * WIDTH * HEIGHT))
    deadline = time.monotonic() + SUBSCRIPTIONS_SEC
    while (seen := publisher.get_subscription_count()) < subscriptions:
        if time.monotonic() > deadline:
            sys.exit(f'{seen} subscriptions in {SUBSCRIPTIONS_SEC:g} s')
        time.sleep(0.01)
    for number in range(1, count + 1):
        picture.header.frame_id = str(number)
        publisher.publish(picture)
    publisher.wait_for_all_acked(Duration(seconds=ARRIVED_SEC))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
