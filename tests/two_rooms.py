"""Two rooms, for tests: open them, and run cells in each."""

from collections.abc import Iterator
from contextlib import contextmanager

from grader.kernels.isolation import require_isolation
from grader.kernels.rooms import GradingRooms

SEED = 'beef'
PUBLISH = """
import threading, time, rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node('talker')
publisher = node.create_publisher(String, '/said', 10)
node.create_timer(0.05, lambda: publisher.publish(String(data='hello')))
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
"""


@contextmanager
def opened_rooms(loop, **options) -> Iterator[GradingRooms]:
    """Open two rooms, in a sandbox if this machine has one; close them at the end."""
    rooms = GradingRooms(seed=SEED, isolated=require_isolation(), **options)
    loop.run(rooms.__aenter__())
    yield rooms
    loop.run(rooms.__aexit__())


def student_in(loop):
    """Return a function that runs a student's cell in rooms."""

    def run(rooms, code, timeout_sec=60.0):
        return loop.run(rooms.run_student_cell(code, timeout_sec=timeout_sec))

    return run


def check_in(loop):
    """Return a function that runs a check in rooms."""
    return lambda rooms, code: loop.run(rooms.run_check(code))


def text_of(cell_run):
    return ''.join(o.get('text', '') for o in cell_run.outputs)


def said(cell_run):
    """Return what a check printed, or its error."""
    return cell_run.error.evalue if cell_run.error else text_of(cell_run)
