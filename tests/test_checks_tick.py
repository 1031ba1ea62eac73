"""A check that passes says so below its cell, in a student's own notebook and nowhere else."""

import os
from pathlib import Path

import nbformat
import pytest
from jupyter_client.manager import start_new_kernel
from my_robot_basics.checks.clock.tick import PASSED, is_check

CHECK = '"""Two and two are four"""\nfrom my_robot_basics.checks import expect\n'
RIGHT = CHECK + "expect(True, expected=4, seen=4, hint='')"
CELLS = {
    'a check that passes': (RIGHT, True),
    'one that fails': (CHECK + "expect(False, expected=4, seen=5, hint='count again')", False),
    'one with an error of its own': (CHECK + '1 / 0', False),
    'a cell of somebody who tries a check': (RIGHT.partition('\n')[2], False),
    'a check that is all hidden': ('"""All is hidden"""\nprint("checked at grading")', False),
    'a check with a syntax error': (CHECK + 'expect(', False),
}


def kernel_in(**environment):
    clean = {k: v for k, v in os.environ.items() if not k.startswith(('PYTEST_', 'MY_ROBOT_'))}
    return start_new_kernel(kernel_name='python3', env=clean | environment)


def printed(client, cell):
    told = []
    client.execute_interactive(cell, timeout=60, output_hook=told.append)
    return ''.join(m['content']['text'] for m in told if m['msg_type'] == 'stream')


@pytest.fixture(scope='module')
def client():
    manager, client = kernel_in()
    yield client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


@pytest.mark.parametrize(('cell', 'passes'), CELLS.values(), ids=CELLS)
def test_only_a_passing_check_prints_that_it_passed(client, cell, passes):
    printed(client, 'import my_robot_basics.checks')
    assert (printed(client, cell) == PASSED + '\n') == passes
    assert (PASSED in printed(client, cell)) == passes


def test_the_first_check_of_a_kernel_prints_once_that_it_passed():
    manager, client = kernel_in()
    try:
        assert [printed(client, RIGHT) for _ in range(2)] == [PASSED + '\n'] * 2
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def test_it_is_printed_in_the_notebooks_language():
    manager, client = kernel_in(JPY_SESSION_NAME='/course/zh_CN/lesson.ipynb')
    try:
        assert printed(client, RIGHT) == '✓ 这个单元格里的检查全部通过。\n'
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def test_a_passing_check_prints_nothing_in_the_test_room():
    manager, client = kernel_in(MY_ROBOT_BASICS_ROOM='test')
    try:
        assert printed(client, RIGHT) == ''
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


@pytest.mark.parametrize('path', sorted(Path(__file__).parents[1].glob('solutions/*/*.ipynb')))
def test_grade_cells_of_the_lessons_are_recognized_as_checks(path):
    notebook = nbformat.read(path, as_version=4)
    graded = [
        cell
        for cell in notebook.cells
        if cell.metadata.get('nbgrader', {}).get('grade') and cell.cell_type == 'code'
    ]
    assert graded
    assert [cell.id for cell in graded if not is_check(cell.source)] in ([], ['reach-hidden'])
