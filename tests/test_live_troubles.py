"""What is known about a node that has stopped: its exception, or the line where it waits."""

import json
import re
from types import SimpleNamespace

import pytest
from my_robot_basics.doctor import inside
from my_robot_basics.doctor.callback import Callback
from my_robot_basics.live.nodes import exercise
from my_robot_basics.live.output import failed_calls, troubles
from my_robot_basics.live.output.panel import Panel
from my_robot_basics.two_link_kinematics import inverse_kinematics
from rclpy.node import Node
from sensor_msgs.msg import JointState

from arm_interfaces.srv import SolveIK
from my_robot_basics import live


@pytest.mark.parametrize('forget', [lambda: troubles.forget('/a'), troubles.forget_all])
def test_an_error_and_an_unpublished_field_are_forgotten_with_their_node(monkeypatch, forget):
    monkeypatch.setattr(failed_calls, 'unpublished_field', lambda error: ('header.stamp', 'Time'))
    troubles.remember('/a', TypeError('no stamp'))
    assert (troubles.last_raised('/a'), troubles.unpublished_field('/a')[0]) == (
        'TypeError: no stamp',
        'header.stamp',
    )
    forget()
    assert (troubles.last_raised('/a'), troubles.last_raised_ns('/a')) == ('', 0)
    assert troubles.unpublished_field('/a') == ('', '')


def test_an_exception_is_told_only_after_its_unpublished_field_is_known(monkeypatch):
    known = []

    def look(error):
        known.append((troubles.last_raised('/a'), troubles.last_raised_ns('/a')))
        return '', ''

    monkeypatch.setattr(failed_calls, 'unpublished_field', look)
    troubles.remember('/a', TypeError('no stamp'))
    assert known == [('', 0)]
    troubles.forget('/a')


def test_an_exception_inside_a_library_is_reported_with_the_librarys_line():
    try:
        json.loads('{')
    except ValueError as error:
        troubles.remember('/a', error.with_traceback(error.__traceback__.tb_next))
    assert ', in raw_decode: ' in troubles.last_raised('/a')
    troubles.forget('/a')


def test_an_exception_of_the_courses_own_function_is_reported_with_the_line_that_calls_it():
    try:
        inverse_kinematics(9.0, 9.0)
    except ValueError as error:
        troubles.remember('/a', error)
    assert ': inverse_kinematics(9.0, 9.0))' in troubles.last_raised('/a')
    troubles.forget('/a')


@pytest.mark.starts
def test_a_wrong_field_of_a_request_and_of_a_response_is_found(run):
    class Server(Node):
        def __init__(self):
            super().__init__('server')
            self.create_service(SolveIK, '/solve_ik', self.solve)

        def solve(self, request, response):
            response.message = ValueError('too far')
            return response

    class Asker(Node):
        def __init__(self):
            super().__init__('asker')
            self.client = self.create_client(SolveIK, '/solve_ik')
            self.create_timer(0.01, self.ask)

        def ask(self):
            self.client.call_async(SolveIK.Request())
            self.client.call_async(SolveIK.Request(target=(1.0, 0.5)))

    run(Server)
    run(Asker)
    live.wait_until(lambda: troubles.last_raised('/server') and troubles.last_raised('/asker'))
    assert troubles.unpublished_field('/server') == ('message', 'string')
    assert troubles.unpublished_field('/asker') == ('target', 'geometry_msgs/Point')


@pytest.mark.starts
def test_publishing_an_object_that_is_not_a_message_names_no_field():
    class Wrong(Node):
        def __init__(self):
            super().__init__('wrong')
            self.publisher = self.create_publisher(JointState, '/wrong', 10)
            self.create_timer(0.01, lambda: self.publisher.publish(5))

    live.run(Wrong)
    live.wait_until(lambda: troubles.last_raised('/wrong'))
    assert troubles.last_raised('/wrong').startswith('TypeError')
    assert troubles.unpublished_field('/wrong') == ('', '')
    live.stop()


def test_unfinished_returns_the_line_of_a_callback_that_keeps_a_node_busy(monkeypatch):
    def callback(line, *holds):
        return Callback(node_name='', name='f', line=line, seconds=1.0, holds=holds)

    found = [callback('line 1', '/b'), callback('', '/a'), callback('line 3', '/a', '/b')]
    seen = SimpleNamespace(look=lambda: None, callbacks=lambda at_least_sec: found)
    monkeypatch.setattr(inside, 'Inside', lambda: seen)
    monkeypatch.setattr(troubles.time, 'sleep', lambda seconds: None)
    assert troubles.blocking_line('/a') == 'line 3'
    assert troubles.blocking_line('/b') == 'line 1'
    assert troubles.blocking_line('/c') == ''


def test_a_node_of_the_answer_that_nothing_spins_is_refused(monkeypatch):
    class Answer:
        executor = None

    earlier = type('Answer', (), {'executor': None})  # of the same cell, before it was changed
    for node, words in ((Answer(), 'leave out the line'), (earlier(), 'from before it was')):
        monkeypatch.setattr(exercise, 'nodes_here', lambda node=node: [node])
        with pytest.raises(exercise.NotRunnable, match=words):
            exercise._expect_no_idle_node(Answer)


@pytest.mark.parametrize(
    ('name', 'executor'), [('Answer', 'spins'), ('Other', None)], ids=['spun', 'another node']
)
def test_any_other_node_is_not(monkeypatch, name, executor):
    others = [type(name, (), {'executor': executor})()]
    monkeypatch.setattr(exercise, 'nodes_here', lambda: others)
    exercise._expect_no_idle_node(type('Answer', (), {}))


def test_a_panel_names_the_line_of_an_exception_in_the_language_of_the_lesson(monkeypatch, capsys):
    monkeypatch.setenv('JPY_SESSION_NAME', 'notebooks/zh_CN/07_common_errors.ipynb')
    try:
        json.loads('{')
    except ValueError as error:
        Panel('Arm').error(error)
    *_, line, goes_on = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r'  decoder\.py，第 \d+ 行，在 raw_decode 里：.+', line)
    assert goes_on == '  Arm 继续运行'
    troubles.forget('')
