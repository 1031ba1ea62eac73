"""Many lessons on one machine at once: each discovers its own nodes and no others."""

import json
import subprocess
import sys

import pytest

LESSON = """
import json, sys, time
import rclpy
from my_robot_basics.live import run, stop
from my_robot_basics.session import classroom
from rclpy.node import Node
from std_msgs.msg import String

class Student(Node):
    def __init__(self, name):
        super().__init__('student')
        self.heard = []
        self.publisher = self.create_publisher(String, '/hello', 10)
        self.create_subscription(String, '/hello', lambda m: self.heard.append(m.data), 10)
        self.create_timer(0.1, lambda: self.publisher.publish(String(data=name)))

student = run(Student, sys.argv[1])
print(json.dumps(classroom.enter()), flush=True)
sys.stdin.readline()  # everybody is there
student.heard.clear()
deadline = time.monotonic() + 60
while len(student.heard) < 20 and time.monotonic() < deadline:
    time.sleep(0.05)
others = [n for n in student.get_node_names() if n != 'student' and not n.startswith('_')]
print(json.dumps({'heard': sorted(set(student.heard)), 'count': len(student.heard),
                  'students': student.get_node_names().count('student'), 'others': others}))
stop()
"""


@pytest.fixture
def crowd():
    started = []

    def start(size):
        for number in range(size):
            command = [sys.executable, '-c', LESSON, str(number)]
            pipes = {'stdin': subprocess.PIPE, 'stdout': subprocess.PIPE}
            started.append(subprocess.Popen(command, text=True, **pipes))
        return started

    yield start
    for process in started:
        process.kill()
        process.communicate()


@pytest.mark.parametrize(
    'size',
    # twenty students with two notebooks each
    [6, pytest.param(40, marks=[pytest.mark.slow, pytest.mark.timeout(600)])],
)
def test_lessons_side_by_side_do_not_receive_each_other_s_messages(crowd, monkeypatch, size):
    monkeypatch.delenv('MY_ROBOT_BASICS_DOMAIN_ID', raising=False)
    lessons = crowd(size)
    domains = [json.loads(lesson.stdout.readline()) for lesson in lessons]
    assert len(set(domains)) == size
    for lesson in lessons:
        lesson.stdin.write('\n')
        lesson.stdin.flush()
    for number, lesson in enumerate(lessons):
        told = json.loads(lesson.stdout.readline())
        assert told.pop('count') >= 20
        assert told == {'heard': [str(number)], 'students': 1, 'others': []}
