"""A node class of the notebook becomes part of a program, or a sentence says what is missing."""

import ast
import linecache
import sys

import pytest
from answered import read
from my_robot_basics.live.packages import program
from my_robot_basics.session.errors import COLUMNS

CELL = """\
import rclpy
from rclpy.node import Node


class MyNode(Node): ...  # your class goes here


def main():
    rclpy.init()
    rclpy.spin(MyNode())
"""
ANSWER = """\
class MyNode(Node):
    # what I think of it
    def __init__(self):
        super().__init__('my_node')
        self.create_timer(1.0, self.tick)

    def tick(self):
        self.get_logger().info(f"it's {np.pi}")
"""


@pytest.fixture
def notebook(monkeypatch):
    """A function that runs a cell as a notebook does; its names are removed after the test."""
    main = sys.modules['__main__']
    made = []

    def run(cell):
        name = f'<cell {len(made)}>'
        linecache.cache[name] = len(cell), None, cell.splitlines(keepends=True), name
        names = {'__name__': '__main__'}
        made.append(name)
        exec(compile('from rclpy.node import Node', name, 'exec'), names)
        exec(compile(cell, name, 'exec'), names)
        for key, value in names.items():
            if not key.startswith('__'):
                monkeypatch.setattr(main, key, value, raising=False)

    yield run
    for name in made:
        del linecache.cache[name]


def refusal(cell=CELL):
    with pytest.raises(program.NotAProgram) as caught:
        program.fill_in(cell)
    lines = caught.value._render_traceback_()
    assert max(map(len, lines)) <= COLUMNS
    return lines


def test_a_cell_without_a_placeholder_class_stays_unchanged():
    text = CELL.replace('...', 'pass')
    assert program.fill_in(text) == text


def test_the_class_is_copied_as_it_was_typed(notebook):
    notebook(f'before = 1\n\n{ANSWER}\nafter = 2\n')
    cell = f'import numpy as np\n{CELL}'
    expected = cell.replace('class MyNode(Node): ...  # your class goes here\n', ANSWER)
    assert program.fill_in(cell) == expected


def test_the_class_that_was_run_last_is_copied_with_its_decorators(notebook):
    notebook(ANSWER.replace('1.0', '2.0'))
    twice = f'def same(x):\n    return x\n\n{ANSWER}\n@same\n{ANSWER.replace("1.0", "3.0")}'
    notebook(twice)
    filled = program.fill_in(f'import numpy as np\nfrom x import same\n{CELL}')
    assert '@same\nclass MyNode' in filled
    assert '3.0' in filled
    assert '2.0' not in filled


def test_names_of_other_cells_are_reported_with_the_lines_to_add(notebook):
    notebook('import numpy as np\nfrom sensor_msgs.msg import JointState as State\nLIMIT = 90\n')
    names = 'State, LIMIT, display, nowhere, np'
    notebook(ANSWER.replace('np.pi', names))
    first, *lines = refusal()
    assert first.startswith('NotAProgram: the program would not know these names')
    assert lines[-5:] == [
        '  LIMIT: copy its definition to a line above the class',
        '  State: add the line   from sensor_msgs.msg import JointState as State',
        '  display: only a notebook has it; leave it out, as well as ! and %',
        '  nowhere: no cell defines it; correct the name',
        '  np: add the line   import numpy as np',
    ]


def test_missing_names_are_reported_indented_in_the_language_of_the_notebook(
    notebook, monkeypatch
):
    monkeypatch.setenv('JPY_SESSION_NAME', 'zh_CN/03_publisher/03_publisher.ipynb')
    notebook('import numpy as np\nLIMIT = 90\n')
    notebook(ANSWER.replace('np.pi', 'LIMIT, display, nowhere, np'))
    first, *lines = refusal()
    assert first.startswith('NotAProgram: 程序不会认识这些名称')
    assert lines[-4:] == [
        '  LIMIT：把它的定义抄到类上面的一行',
        '  display：只有 notebook 里才有；请去掉，! 和 % 也一样',
        '  nowhere：没有单元格定义它；请改正名称',
        '  np：加上这一行   import numpy as np',
    ]


@pytest.mark.parametrize(
    'line',
    [
        'import math',
        'import numpy as np',
        'import os.path as p',
        'from math import radians',
        'from random import uniform',
        'from time import sleep as nap',
        'from rclpy.node import Node',
        'from rclpy.qos import QoSProfile',
        'from sensor_msgs.msg import JointState',
        'from builtin_interfaces.msg import Time',
    ],
)
def test_a_proposed_import_line_imports_the_same_object(line):
    names, again = {}, {}
    exec(line, names)
    name = ast.parse(line).body[0].names[0]
    name = name.asname or name.name
    proposed = program.import_line(name, names[name])
    exec(proposed, again)
    assert again[name] is names[name]
    if 'os.path' not in line:
        assert proposed == line


def test_an_object_that_cannot_be_imported_has_no_import_line(notebook):
    notebook(ANSWER)
    for thing in (90, [1], sys.modules['__main__'].MyNode, lambda: None):
        assert program.import_line('thing', thing) == ''


def test_the_error_about_a_missing_class_says_which_cell_to_run():
    said = 'there is no class MyNode yet: run the cell in which you write it, then'
    with pytest.raises(program.NotAnswered, match=said):
        program.fill_in(CELL)


def test_a_class_of_another_module_is_not_copied(notebook):
    notebook('from rclpy.node import Node as MyNode\n')
    assert 'MyNode is not a class of this notebook' in ' '.join(refusal())


def test_the_released_answer_is_reported_as_doing_nothing_yet(notebook):
    released = {cell.id: cell.source for cell in read('notebooks', '03_publisher').cells}
    notebook(released['five_hz'])
    with pytest.raises(program.NotAnswered, match='KinematicsPublisher does nothing yet: answer'):
        program.fill_in(released['own_file'].partition('\n')[2])


def test_a_class_may_leave_everything_to_its_base_class(notebook):
    notebook(f'import numpy as np\n{ANSWER}\nBase = MyNode\n')
    notebook('class MyNode(__import__("__main__").Base):\n    def own(self):\n        pass\n')
    assert 'def own(self)' in program.fill_in(CELL.replace('rclpy.node', 'x'))


def test_a_class_without_source_text_is_refused(notebook):
    notebook(ANSWER)
    for name in [n for n in linecache.cache if n.startswith('<cell')]:
        linecache.cache[name] = 0, None, [], name
    assert 'put the class itself' in ' '.join(refusal())


def test_invalid_python_is_reported_with_the_line_of_the_cell():
    [line] = refusal('import rclpy\n\ndef main(:\n')
    # the magic is line 1
    assert 'not valid Python (line 4: ' in line


def test_bound_names_are_found_in_each_form_of_binding():
    text = """
import a.b
from c import d as e
def f(g=1, *h, **i): global j; j = [k for k in h]; return g, i, __name__
class K:
    l = 1
    m = l
try: n = 1
except OSError as o: o
"""
    assert program.names_missing_in(text) == []
    assert program.names_missing_in(f'{text}\nprint(d, j, l)') == ['d', 'l']
    assert program.names_missing_in(f'from x import *\n{text}\nprint(d, l)') == []
