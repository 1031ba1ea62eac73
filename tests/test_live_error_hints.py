"""Below an exception of a cell stands what to do about it, as Validate says it."""

import re

import pytest
from answered import ROOT
from opened_lesson import OpenedLesson

SAID = 'this cell raised'
CLIENT = """
class IKClient(Node):
    def __init__(self):
        super().__init__('ik_client')
        self.create_subscription(Point, '/target_point', {given}, 10)

    def ask({parameters}):
        pass
"""
IN_WORDS = (
    'so give it a function that takes one message, by its name and without parentheses; the def '
    'of a method begins with self: (self, message)'
)


@pytest.fixture(scope='module')
def lesson():
    opened = OpenedLesson(ROOT / 'notebooks/08_services/08_services.ipynb')
    opened.run('imports')
    opened.run('ik_client-reset')
    yield opened
    opened.close()


@pytest.mark.parametrize(
    ('given', 'parameters'),
    [
        ('self.ask', 'target'),
        ('self.ask', 'self'),
        ('self.ask', 'self, request, response, more'),
        ('self.ask()', 'self'),
    ],
)
def test_a_callback_that_takes_no_message_is_explained(lesson, given, parameters):
    answer = CLIENT.format(given=given, parameters=parameters)
    assert lesson.run('ik_client', answer) == ''
    assert SAID not in lesson.printed
    assert re.search(r'callback should be either|not a callable', lesson.run('ik_client-run'))
    assert f'{SAID} `' in lesson.printed
    assert lesson.printed.endswith(IN_WORDS)


@pytest.mark.parametrize(
    ('source', 'hint'),
    [
        (
            'class Mine(Node):\ndef solve(self): pass',
            'so begin the lines of that block with four more spaces',
        ),
        ('ask(full_name, guess=/station)', "so write a text in quotes, as in guess='/station'"),
        ('ask(late, guess=[2 3])', 'commas between the values of a list'),
        ('ask(late, guess="a" b)', ''),
        ('x = 0\nx++', 'so write += 1'),
        ('print(true)', 'so write True, False or None with a capital letter'),
        ('[1, 2](0)', ''),
        ('raise NotRunnable("do this")', ''),
        ('stop(\n', ''),
    ],
)
def test_any_cell_has_the_hint_that_validate_has(lesson, source, hint):
    lesson.run('x', 'from my_robot_basics.session.errors import NotRunnable')
    assert lesson.run('ik_client', source)
    if hint:
        assert hint in lesson.printed
    else:
        assert SAID not in lesson.printed


def test_the_chinese_edition_has_it_in_chinese():
    opened = OpenedLesson(ROOT / 'notebooks/zh_CN/08_services/08_services.ipynb')
    try:
        assert opened.run('gripper', 'work_sec = 1；')
        assert opened.printed.startswith('这个单元格抛出了 `SyntaxError: invalid character')
        assert opened.printed.endswith("请改写成 ';'")
    finally:
        opened.close()


def test_a_cell_that_has_to_run_first_is_all_that_is_said(lesson):
    assert "name 'Gripper' is not defined" in lesson.run('first_call', 'Gripper')
    assert 'comes from cell' in lesson.printed
    assert SAID not in lesson.printed
