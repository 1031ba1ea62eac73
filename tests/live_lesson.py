"""A lesson in a real kernel, run cell by cell, for tests of `live` in kernels."""

import contextlib
import os
import queue
import re
import subprocess
import time

from jupyter_client.manager import start_new_kernel

TALKER = """
from my_robot_basics.live import follow_arm, reset, run, run_answer, show_arm, stop
from my_robot_basics.session import classroom
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self, text='x', period_sec=0.05):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, '/talk', 10)
        self.get_logger().info(f'made with {text}\\nin two lines')
        self.text, self.count = text, 0
        self.create_timer(period_sec, self.tick)

    def tick(self):
        self.count += 1
        self.publisher.publish(String(data=self.text))

def publishers(topic_name='/talk'):
    watcher = rclpy.create_node('_watcher')
    names = [info.node_name for info in watcher.get_publishers_info_by_topic(topic_name)]
    watcher.destroy_node()
    return names

def alive(node):
    import time
    before, deadline = node.count, time.monotonic() + 10
    while node.count < before + 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    return node.count >= before + 2

def frozen(node):
    import time
    before = node.count
    time.sleep(0.3)
    return node.count == before
"""


class Lesson:
    """A kernel, and the outputs of each cell that was run in it."""

    def __init__(self, *setup):
        # otherwise ipykernel's debugger may write a warning to stderr when it starts
        env = os.environ | {'PYDEVD_DISABLE_FILE_VALIDATION': '1'}
        self.manager, self.client = start_new_kernel(
            kernel_name='python3', stderr=subprocess.PIPE, env=env
        )
        self.messages = {}
        for source in setup:
            assert self.run(source).error is None

    def send(self, source):
        cell = Cell(self, self.client.execute(source))
        self.messages[cell.id] = []
        return cell

    def run(self, source):
        cell = self.send(source)
        self.wait_for(lambda: cell.done)
        return cell

    def wait_for(self, condition, timeout_sec=30):
        """Receive messages until the condition is true; return whether it is."""
        deadline = time.monotonic() + timeout_sec
        while not condition() and time.monotonic() < deadline:
            with contextlib.suppress(queue.Empty):
                message = self.client.get_iopub_msg(timeout=0.1)
                parent_id = message['parent_header'].get('msg_id')
                self.messages.setdefault(parent_id, []).append(message)
        return condition()

    def value(self, expression):
        """Return the repr of an expression's value."""
        cell = self.run(f'print(repr(({expression})))')
        assert cell.error is None
        return cell.stdout.strip()

    def restart(self):
        """Restart the kernel as JupyterLab does."""
        self.manager.restart_kernel()
        self.client.wait_for_ready(timeout=60)

    def shut_down(self):
        """Shut the kernel down as JupyterLab does; return its exit status and its stderr."""
        process = self.manager.provisioner.process
        self.client.stop_channels()
        self.manager.request_shutdown()
        process.wait(timeout=30)
        stderr = process.stderr.read().decode()
        self.manager.shutdown_kernel(now=True)
        return process.returncode, stderr


class Cell:
    """The outputs of one cell, also those that arrive after its end."""

    def __init__(self, lesson, message_id):
        self.id = message_id
        self._lesson = lesson

    def _contents(self, *types):
        return [m['content'] for m in self._lesson.messages[self.id] if m['msg_type'] in types]

    @property
    def done(self):
        return any(c['execution_state'] == 'idle' for c in self._contents('status'))

    @property
    def stdout(self):
        return ''.join(c['text'] for c in self._contents('stream') if c['name'] == 'stdout')

    @property
    def stderr(self):
        return ''.join(c['text'] for c in self._contents('stream') if c['name'] == 'stderr')

    @property
    def error(self):
        return next(
            (
                re.sub(r'\x1b\[\d[\d;]*m', '', '\n'.join(c['traceback']))
                for c in self._contents('error')
            ),
            None,
        )

    @property
    def displays(self):
        """The states of the cell's display, oldest first."""
        return self._contents('display_data', 'update_display_data')

    @property
    def panel(self):
        """The current text of the panel."""
        return self.displays[-1]['data']['text/plain'] if self.displays else ''


SILENT = """class Silent(Node):
    def __init__(self):
        super().__init__('silent')"""


def opened_lesson():
    """Yield a lesson with TALKER; check at the end that its kernel wrote nothing to stderr."""
    lesson = Lesson(TALKER)
    yield lesson
    for cell_id in lesson.messages:
        assert Cell(lesson, cell_id).stderr == ''
    returncode, stderr = lesson.shut_down()
    assert returncode == 0
    assert 'terminate called' not in stderr


def stop_nodes_after(request):
    """Stop all nodes of the fixture `lesson` after a test."""
    yield
    if 'lesson' in request.fixturenames:
        lesson = request.getfixturevalue('lesson')
        stop = lesson.run('stop()')
        if not stop.done:  # a cell hangs: its test has failed, but the next ones must not
            lesson.restart()
            stop = lesson.run(TALKER)
        assert stop.error is None
