"""A running lesson is announced, and a terminal that names no domain joins the latest one."""

import contextlib
import os
import subprocess
import sys
import time

import pytest
from jupyter_client.manager import start_new_kernel
from my_robot_basics.session import domain, lessons
from ros2_command import TIMEOUT_SEC, ros2

TALK = """
from std_msgs.msg import Int32
from my_robot_basics.live import run, show_domain
from rclpy.node import Node

show_domain()
node = run(Node, '{name}')
publisher = node.create_publisher(Int32, '/{name}', 10)
"""
PLAIN_TERMINAL = {'ROS_DOMAIN_ID': ''}


@contextlib.contextmanager
def kernel(folder, name, **environment):
    """A notebook's kernel, as JupyterLab starts it: runs a cell, and returns what it printed."""
    folder = folder / name
    folder.mkdir()
    manager, client = start_new_kernel(cwd=str(folder), env={**os.environ, **environment})
    printed = []

    def hear(message):
        if message['msg_type'] in ('stream', 'error'):
            printed.append(message['content'].get('text', 'error'))

    def run_cell(source):
        printed.clear()
        client.execute_interactive(
            source, timeout=TIMEOUT_SEC, output_hook=hear, stop_on_error=False
        )
        return ''.join(printed)

    try:
        yield run_cell
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def running_lessons_in(folder):
    """The running lessons of this test: other kernels of this machine may run lessons, too."""
    names = {path.name for path in folder.iterdir()}
    return [lesson for lesson in lessons.running() if lesson.name in names]


def test_each_lesson_prints_the_line_with_which_a_terminal_joins_it(tmp_path):
    with kernel(tmp_path, 'first') as first_cell, kernel(tmp_path, 'second') as second_cell:
        for name, run_cell in ('first', first_cell), ('second', second_cell):
            said = run_cell(TALK.format(name=name))
            lesson = running_lessons_in(tmp_path)[-1]
            assert lesson.name == name
            line = f'join this lesson: export ROS_DOMAIN_ID={lesson.domain_id}\n'
            assert said.startswith(f'In a terminal, {line}')
            listed = ros2('topic', 'list', ROS_DOMAIN_ID=str(lesson.domain_id))
            assert listed.err == ''
            assert {'/first', '/second'} & set(listed.out.split()) == {f'/{name}'}
        assert [lesson.name for lesson in running_lessons_in(tmp_path)] == ['first', 'second']
    # a kernel that is killed runs no more
    assert running_lessons_in(tmp_path) == []


def test_a_terminal_joins_the_lesson_that_started_last_and_says_so(tmp_path):
    with kernel(tmp_path, 'latest') as run_cell:
        run_cell(TALK.format(name='latest'))
        for _ in range(20):
            # lessons of other tests start meanwhile
            run_cell('from my_robot_basics.session import classroom, lessons')
            assert run_cell('lessons.announce(classroom.enter())') == ''
            listed = ros2('topic', 'list', **PLAIN_TERMINAL)
            if ' latest, ' in listed.err:
                break
        (lesson,) = running_lessons_in(tmp_path)
        assert listed.err == (
            f'joined the lesson latest, which started last: ROS_DOMAIN_ID={lesson.domain_id}\n'
        )
        assert '/latest' in listed.out.split()


def test_a_ros2_verb_that_needs_no_graph_prints_no_message_about_domains(tmp_path):
    with kernel(tmp_path, 'some_lesson') as run_cell:
        run_cell(TALK.format(name='silent'))
        assert running_lessons_in(tmp_path)
        shown = ros2('interface', 'show', 'std_msgs/msg/Int32', **PLAIN_TERMINAL)
    assert (shown.out.splitlines()[-1], shown.err) == ('int32 data', '')


def test_a_lesson_has_the_notebook_name_that_jupyterlab_gives(tmp_path):
    path = str(tmp_path / 'Mein Übungsblatt 3.ipynb')
    with kernel(tmp_path, 'elsewhere', JPY_SESSION_NAME=path) as run_cell:
        run_cell(TALK.format(name='named'))
        assert 'Mein__bungsblatt_3' in [lesson.name for lesson in lessons.running()]


def test_a_grading_room_announces_no_lesson(tmp_path):
    with kernel(tmp_path, 'submission', MY_ROBOT_BASICS_ROOM='student') as run_cell:
        assert 'ROS_DOMAIN_ID=' in run_cell(TALK.format(name='graded'))
        assert running_lessons_in(tmp_path) == []


def test_a_process_that_is_not_a_kernel_is_not_listed_as_a_lesson():
    code = (
        'import os; from my_robot_basics.session import classroom, lessons; classroom.enter()\n'
        'print([lesson for lesson in lessons.running() if lesson.pid == os.getpid()])'
    )
    said = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert (said.stdout, said.stderr) == ('[]\n', '')


ROWS = """Num       RefCount Protocol Flags    Type St Inode Path
0000000000000000: 00000002 00000000 00000000 0002 01 1001 @my_robot_basics.lesson.{rows[0]}
0000000000000000: 00000002 00000000 00000000 0002 01 1002
0000000000000000: 00000002 00000000 00000000 0002 01 1003 @my_robot_basics.domain.7
0000000000000000: 00000002 00000000 00000000 0002 01 1004 @my_robot_basics.lesson.{rows[1]}
0000000000000000: 00000002 00000000 00000000 0002 01 1005 /run/my_robot_basics.lesson.{rows[1]}
"""


@pytest.fixture
def sockets(tmp_path, monkeypatch):
    """What the operating system would list: two lessons."""

    def write(*rows):
        table = tmp_path / 'unix'
        table.write_text(ROWS.format(rows=rows))
        monkeypatch.setattr(lessons, 'SOCKETS', table)

    return write


def test_lessons_are_sorted_by_their_start(sockets):
    sockets(f'3.2000.{os.getpid()}.late', f'9.1000.{os.getpid()}.early')
    early, late = lessons.running()
    assert early == lessons.RunningLesson(1000, 9, os.getpid(), 'early')
    assert late == lessons.RunningLesson(2000, 3, os.getpid(), 'late')


def test_lessons_of_other_users_and_malformed_entries_are_left_out(sockets, monkeypatch):
    other = os.getuid() + 1
    monkeypatch.setattr(os, 'getuid', lambda: other)
    sockets(f'3.2000.{os.getpid()}.theirs', '3.2000.x.y')
    assert lessons.running() == []


def test_no_lesson_is_listed_if_the_socket_table_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(lessons, 'SOCKETS', tmp_path / 'nothing')
    assert lessons.running() == []


def test_the_longest_lesson_name_fits_into_a_socket_address(monkeypatch, tmp_path):
    monkeypatch.setenv('JPY_SESSION_NAME', f'{"x" * 200}.ipynb')
    monkeypatch.setattr(time, 'time_ns', lambda: 2**64)
    monkeypatch.setattr(os, 'getpid', lambda: 2**22)
    monkeypatch.setattr(lessons, '_announcement', None)
    lessons.announce(domain.LAST)
    assert len(lessons._announcement.getsockname()) <= 108
    lessons._announcement.close()
