"""The checks of docs/writing-exercises.md on servers and clients, graded in rooms."""

import inspect
import re

import nbformat
import pytest
from course_maker import make_course
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook
from nodes.running import imported

from grader.__main__ import main
from grader.authoring.release import release
from grader.course import ROOT
from grader.grade import grade_all
from grader.storage.gradebook import register
from grader.storage.submitted import find_submissions

PAGE = (ROOT / 'docs/writing-exercises.md').read_text(encoding='utf-8')
LESSON = '00_toy'
SETUP = """\
import math

from action_msgs.msg import GoalStatus
from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK
from geometry_msgs.msg import Point
from my_robot_basics.two_link_kinematics import inverse_kinematics
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Int64, String

LIMITS_RAD, STEP_SEC = (math.radians(90.0), math.radians(120.0)), 0.05
WORDS = {4: 'succeeded', 5: 'canceled', 6: 'aborted'}
"""
MODULES = {
    'IKService': 'ik_service',
    'IKClient': 'ik_client',
    'MoveArmServer': 'move_arm_server',
    'MoveArmClient': 'move_arm_client',
}
RIGHT = {
    name: inspect.getsource(getattr(imported(module), name)) for name, module in MODULES.items()
}
BLOCKS = """\
    def ask(self, target):
        self.answer(self.client.call(SolveIK.Request(target=target)))

    def answer("""
WRONG = {
    'IKService': RIGHT['IKService'].replace('        return response\n\n', '\n'),
    'IKClient': re.sub(
        r'    def ask\(.*?    def answer\(', lambda _: BLOCKS, RIGHT['IKClient'], flags=re.S
    ),
    'MoveArmServer': RIGHT['MoveArmServer'].replace('handle.succeed()', 'pass'),
    'MoveArmClient': RIGHT['MoveArmClient'].replace("self.tell('rejected')", 'pass'),
}
REASONS = {
    'ik_service_answers': 'end the callback with `return response`',
    'ik_client_never_blocks': 'it called `/solve_ik` inside a callback and waited there',
    'move_arm_server_reaches': 'call goal_handle.succeed() before the execute callback returns',
    'move_arm_client_outcomes': 'a goal that is not accepted has no result',
}


def checks_of(section):
    """The checks that a section of the guide shows."""
    text = PAGE.partition(f'## {section}\n')[2].partition('\n## ')[0]
    return re.findall(r'^```python\n(""".*?)^```', text, re.M | re.S)


CHECKS = [*checks_of('A service'), *checks_of('An action')]


def exercise(name, check_id, check):
    """The cells of one exercise: reset, answer, run, check."""
    marks = {'grade': False, 'solution': False, 'locked': True, 'task': False, 'schema_version': 3}
    reset = f'from my_robot_basics.live import reset\n\nreset({name!r})'
    run = f'from my_robot_basics.live import run_answer\n\nnode = run_answer({name!r})'
    answer = f'### BEGIN SOLUTION\n{RIGHT[name]}### END SOLUTION'
    exercise_id = MODULES[name]
    for cell_id, source, more in (
        (f'{exercise_id}-reset', reset, {}),
        (exercise_id, answer, {'solution': True, 'locked': False}),
        (f'{exercise_id}-run', run, {}),
        (check_id, check, {'grade': True, 'points': 2}),
    ):
        cell = new_code_cell(source, id=cell_id)
        cell.metadata.nbgrader = marks | more | {'grade_id': cell_id}
        yield cell


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    course = make_course(tmp_path_factory.mktemp('services'))
    cells = [new_markdown_cell('# 0 · Services', id='title'), new_code_cell(SETUP, id='setup')]
    for name, check_id, check in zip(RIGHT, REASONS, CHECKS, strict=True):
        cells += exercise(name, check_id, check.rstrip('\n'))
    nbformat.write(nbformat.from_dict(new_notebook(cells=cells)), course.source_path(LESSON))
    release(course)
    register(course, LESSON)
    return course


@pytest.mark.slow
@pytest.mark.isolation
def test_right_answers_earn_all_points_and_wrong_ones_get_the_cause(course):
    for student, answers in (('right', RIGHT), ('wrong', WRONG)):
        notebook = course.release(LESSON)
        for cell in notebook.cells:
            for name, answer in answers.items():
                if cell.id == MODULES[name]:
                    cell.source = answer
        path = course.folder('submitted', student, LESSON) / f'{LESSON}.ipynb'
        path.parent.mkdir(parents=True)
        nbformat.write(notebook, path)
    rows = {row.student_id: row for row in grade_all(course, find_submissions(course))}
    assert rows['right'].stored.score == 2 * len(RIGHT), rows['right'].reason
    assert rows['wrong'].stored.score == 0
    assert main(['scores'], course=course) == 0
    table = (course.gradebook / 'scores.csv').read_text(encoding='utf-8-sig')
    for reason in REASONS.values():
        assert reason in table
