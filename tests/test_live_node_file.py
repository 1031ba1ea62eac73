"""A student's own node goes from a cell into the workspace, and nothing that was there is lost."""

import re

import pytest
from my_robot_basics.live.packages import node_file
from my_robot_basics.live.packages.workspace import make_workspace

NODE = 'print("mine")\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    folder = tmp_path / 'ros ws'
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(folder))
    return folder


@pytest.fixture
def modules(folder, capsys):
    make_workspace()
    capsys.readouterr()
    return folder / 'src/my_robot_basics/my_robot_basics'


def test_a_cell_becomes_a_module_of_the_package(modules, capsys):
    node_file.write_node(' greeter.py ', NODE)
    assert (modules / 'greeter.py').read_text() == NODE
    written = 'written  $ROS_WS/src/my_robot_basics/my_robot_basics/greeter.py\n'
    assert capsys.readouterr().out == written
    node_file.write_node('greeter.py', NODE)  # the cell again
    assert capsys.readouterr().out == written


def test_an_edited_file_is_moved_aside_before_it_is_overwritten(folder, modules, capsys):
    for number in (1, 2):
        (modules / 'greeter.py').write_text(f'edited {number}')
        node_file.write_node('greeter.py', NODE)
        assert (folder / f'kept/greeter_{number}.py').read_text() == f'edited {number}'
        assert f'moved    $ROS_WS/kept/greeter_{number}.py: ' in capsys.readouterr().out
        assert (modules / 'greeter.py').read_text() == NODE
    assert (folder / 'kept/COLCON_IGNORE').is_file()


@pytest.mark.parametrize('name', ['', 'greeter', 'my node.py', '../greeter.py', '/tmp/greeter.py'])
def test_an_invalid_module_name_is_refused(modules, name):
    before = sorted(modules.iterdir())
    with pytest.raises(node_file.NotWritten, match='expected a name such as'):
        node_file.write_node(name, NODE)
    assert sorted(modules.iterdir()) == before


def test_the_error_without_a_workspace_names_the_cell_to_run(folder):
    with pytest.raises(node_file.NotWritten, match=r'run the cell with make_workspace\(\) first'):
        node_file.write_node('greeter.py', NODE)


OPEN = 'class NoSuchClass: ...\n'


def test_a_missing_class_is_reported_and_the_file_is_not_written(modules, capsys):
    node_file.write_node('own.py', OPEN)
    said = capsys.readouterr().out
    assert said.startswith('not written: there is no class NoSuchClass yet: run the cell in which')
    assert not (modules / 'own.py').exists()
    (modules / 'own.py').write_text('mine')
    node_file.write_node('own.py', OPEN)
    assert '(own.py stays as it was)' in ' '.join(capsys.readouterr().out.split())
    assert (modules / 'own.py').read_text() == 'mine'


def test_a_class_of_the_notebook_is_copied_and_the_file_is_shown(modules, capsys, monkeypatch):
    monkeypatch.setattr(node_file.program, 'fill_in', lambda cell: cell.replace('...', 'pass'))
    node_file.write_node('own.py', OPEN)
    assert (modules / 'own.py').read_text() == 'class NoSuchClass: pass\n'
    _, _, shown = capsys.readouterr().out.partition('\n')
    assert shown == '\nclass NoSuchClass: pass\n'


def test_a_cell_that_is_not_valid_python_does_not_change_the_file(modules):
    (modules / 'own.py').write_text('mine')
    with pytest.raises(node_file.program.NotAProgram, match='not valid Python'):
        node_file.write_node('own.py', 'def main(:\n')
    assert (modules / 'own.py').read_text() == 'mine'


def test_the_workspace_tree_shows_folders_and_the_students_files(folder, modules, capsys):
    node_file.write_node('greeter.py', NODE)
    (folder / 'build').mkdir()
    capsys.readouterr()
    node_file.show_workspace()
    lines = [re.search(r'[\w$./]+', line)[0] for line in capsys.readouterr().out.splitlines()]
    package = ['my_robot_basics/', 'package.xml', 'setup.py', 'my_robot_basics/', 'greeter.py']
    assert lines == ['$ROS_WS/', 'src/', *package, 'build/']
