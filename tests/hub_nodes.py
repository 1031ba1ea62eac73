"""Code that a hub's users run in kernels: publish, disturb another student, build a package."""

MESSAGES = 20
MEANS_IT = """
import os
os.environ |= {
    'ROS_DOMAIN_ID': '7',
    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET',
    'ROS_STATIC_PEERS': '127.0.0.1',
    'FASTDDS_BUILTIN_TRANSPORTS': 'UDPv4',
}
import subprocess, threading, time, rclpy
from std_msgs.msg import String
"""
"""The settings of a user who tries to reach nodes of other users on the same machine."""
RUN = (
    MEANS_IT
    + """
rclpy.init()
heard = []
node = rclpy.create_node('node_of_%(name)s')
talks = node.create_publisher(String, '/talk_of_%(name)s', 10)
node.create_subscription(String, '/orders_of_%(name)s', lambda m: heard.append(m.data), 50)
node.create_timer(0.05, lambda: talks.publish(String(data='mine')))
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
"""
)
"""A node that publishes, and subscribes to orders that anyone may publish."""
LIST = (
    MEANS_IT
    + """
own = {'/node_of_%(name)s', '/talk_of_%(name)s'}
seen = set()
at_most = time.monotonic() + 60
while not own <= seen and time.monotonic() < at_most:
    seen.clear()
    for what in 'node', 'topic':
        words = ['ros2', what, 'list', '--no-daemon', '--spin-time', '3']
        seen.update(subprocess.run(words, stdout=-1, text=True, check=True).stdout.split())
print(*sorted(seen))
"""
)
"""Prints all nodes and topics that are found; it repeats until those of `name` are among them."""
LISTEN_AND_INJECT = (
    MEANS_IT
    + """
rclpy.init()
stranger = rclpy.create_node('stranger')
listened = []
stranger.create_subscription(String, '/talk_of_%(name)s', lambda m: listened.append(m.data), 50)
orders = stranger.create_publisher(String, '/orders_of_%(name)s', 50)
at_most = time.monotonic() + 5
while time.monotonic() < at_most and not (listened and orders.get_subscription_count()):
    rclpy.spin_once(stranger, timeout_sec=0.1)
for number in range({number}):
    orders.publish(String(data=str(number)))
    rclpy.spin_once(stranger, timeout_sec=0.05)
reached = orders.get_subscription_count() and orders.wait_for_all_acked(
    rclpy.duration.Duration(seconds=30)
)
print(bool(listened), bool(reached))
stranger.destroy_node()
""".replace('{number}', str(MESSAGES))
)
"""Prints whether a message was received, and whether any subscriber acknowledged the orders."""
LOOK_AROUND = """
import os, pathlib
print(os.listdir('/home'))
print(os.listdir('/tmp'))
print({path.owner() for path in pathlib.Path('/proc').glob('[0-9]*')})
print(pathlib.Path('/proc/net/unix').read_text().count('@'))
"""
"""Prints the homes and temporary files, the processes' owners, the number of abstract sockets."""
BUILD = """
import os, pathlib, shutil, subprocess
from my_robot_basics.live.packages.workspace import BUILD, make_workspace
make_workspace()
words = ['bash', '--rcfile', os.environ['COURSE_TERMINAL'], '-i', '-c']
words.append(f'{BUILD} >&2 && ros2 pkg prefix my_robot_basics')
done = subprocess.run(words, capture_output=True, text=True)
assert done.returncode == 0, done.stderr
print('built', done.stdout.split()[-1])
bundle = pathlib.Path(os.environ['COURSE_TERMINAL']).parents[3]
shutil.copytree(bundle / 'notebooks/03_publisher', 'arm')
"""
"""Builds the workspace as in a terminal, prints the package's path, and copies lesson 3."""
COMMAND = """
import subprocess
done = subprocess.run(%r, shell=True, stdout=-1, stderr=-2, text=True)
print(done.stdout)
assert done.returncode == 0
"""
"""Runs a command, prints its output, and fails if the command fails."""
