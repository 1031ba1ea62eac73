"""A lesson whose answer is a ROS package, and packages for it, right and wrong."""

import re
from pathlib import Path

import nbformat
from my_robot_basics.ros2 import skeleton
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from grader.course import ROOT

LESSON, PACKAGE = '00_greeter', 'greeter'
NODE = """
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.declare_parameter('words', 'hello')
        self.publisher = self.create_publisher(String, '/greeting', 10)
        self.create_timer(0.1, self.greet)
        self.get_logger().info('greeting')

    def greet(self):
        self.publisher.publish(String(data=self.get_parameter('words').value))


def main(args=None):
    try:
        rclpy.init(args=args)
        rclpy.spin(Greeter())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
"""
_BLOCK = re.compile(r'\*\*`(\w+)`\*\*[^\n]*\n\n```python\n(.*?)```', re.DOTALL)
CELLS = dict(_BLOCK.findall((ROOT / 'docs/grading-a-package.md').read_text(encoding='utf-8')))
"""The cells of the instructors' page, by id."""


def cell(grade_id: str, source: str, **marks: object) -> NotebookNode:
    given = {'grade': False, 'solution': False, 'locked': True, 'task': False}
    about = given | {'grade_id': grade_id, 'schema_version': 3} | marks
    return new_code_cell(source, id=grade_id, metadata={'nbgrader': about})


def package_lesson(*, builds: str = CELLS['builds'], runs: str = CELLS['runs']) -> NotebookNode:
    """Return the source of the lesson: its title, and an exercise without a student's cell."""
    return new_notebook(
        cells=[
            new_markdown_cell('# A package', id='title'),
            cell('greeter-reset', 'from my_robot_basics.live import reset\nreset()'),
            cell('greeter', CELLS['greeter']),
            new_code_cell('print("theirs")', id='try-it'),
            cell('builds', builds, grade=True, points=1.0),
            cell('runs', runs, grade=True, points=2.0),
        ],
        metadata={'kernelspec': {'name': 'python3', 'display_name': 'Python 3'}},
    )


def write_lesson(root: Path) -> Path:
    """Write the lesson into a course's solutions/; return its path."""
    path = root / 'solutions' / LESSON / f'{LESSON}.ipynb'
    path.parent.mkdir(parents=True)
    nbformat.write(package_lesson(), path)
    return path


def make_package(above: Path, *, node: str = NODE, **files: str | None) -> Path:
    """Make a right package, with other files by path (__ for /); None removes a file."""
    above.mkdir(parents=True, exist_ok=True)
    skeleton.make(above, PACKAGE, node_name='greet', dependencies=('rclpy', 'std_msgs'))
    folder = above / PACKAGE
    (folder / PACKAGE / 'greet.py').write_text(node)
    for name, text in files.items():
        path = folder / name.replace('__', '/')
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text) if text is not None else path.unlink()
    return folder
