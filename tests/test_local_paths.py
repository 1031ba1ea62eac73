import sys
from pathlib import Path

import pytest
from course_maker import answered, released_course
from my_robot_basics.validate.lessons.cells import KEY, grade_id
from nbformat.v4 import new_code_cell, new_notebook, new_output

from grader.course import ROOT
from grader.judging.execute import execute
from grader.judging.local_paths import hide_local_paths, shorten_local_paths
from grader.kernels.isolation import require_isolation
from grader.notebook.restore import restore
from grader.storage.pipeline import sanitize_restored


@pytest.mark.parametrize(
    ('text', 'shown'),
    [
        (f'{ROOT}/my_robot_basics/setup.py, line 3', 'my_robot_basics/setup.py, line 3'),
        (f"'{ROOT}'", "'.'"),
        (f'{sys.prefix}/lib/rclpy/node.py', '.venv/lib/rclpy/node.py'),
        (f'{Path.home()}/notes', '~/notes'),
        (f'{Path.home()}other/notes', f'{Path.home()}other/notes'),
        ('/usr/lib/python3/os.py and /tmp/x', '/usr/lib/python3/os.py and /tmp/x'),
    ],
)
def test_folders_of_this_machine_are_shortened(text, shown):
    assert shorten_local_paths(text) == shown


def test_paths_are_shortened_in_all_texts_but_not_in_pictures():
    picture = f'{ROOT}/aGk='
    cell = new_code_cell('x')
    cell.outputs = [
        new_output('stream', text=f'{ROOT}/a'),
        new_output('error', ename='E', evalue=f'{ROOT}/b', traceback=['at', f'{ROOT}/c']),
        new_output('display_data', {'image/png': picture, 'text/plain': f'{ROOT}/d'}),
    ]
    cell.metadata[KEY] = {'reason': f'{ROOT}/e', 'notes': [f'{ROOT}/f'], 'points': 1.0}
    hide_local_paths(new_notebook(cells=[cell]))
    stream, error, display = cell.outputs
    assert (stream.text, error.evalue, error.traceback) == ('a', 'b', ['at', 'c'])
    assert display.data == {'image/png': picture, 'text/plain': 'd'}
    assert cell.metadata[KEY] == {'reason': 'e', 'notes': ['f'], 'points': 1.0}


@pytest.mark.starts
def test_a_graded_notebook_does_not_contain_the_path_of_the_course(tmp_path):
    course = released_course(tmp_path)
    answer = 'import rclpy\nprint(rclpy.__file__)\nfrom my_robot_basics.live import nothing_such'
    restored = restore(answered(course, answer), course.template('00_toy')).notebook
    graded = execute(
        sanitize_restored(course, '00_toy', restored), trust_students=not require_isolation()
    ).notebook
    (said,) = [cell for cell in graded.cells if grade_id(cell) == 'double']
    assert '.venv/lib/python' in said.outputs[0].text
    assert 'cannot import name' in said.outputs[1].evalue
    check = next(cell for cell in graded.cells if grade_id(cell) == 'double-check')
    assert 'my_robot_basics/my_robot_basics/live/__init__.py' in str(check.metadata[KEY])
    everything = str([(cell.get('outputs'), cell.metadata) for cell in graded.cells])
    assert str(ROOT) not in everything
