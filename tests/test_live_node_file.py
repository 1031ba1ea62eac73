"""A student's own node goes from a cell into the workspace, and nothing that was there is lost."""

import re

import pytest
from my_robot_basics.live import node_file
from my_robot_basics.live.workspace import make_workspace

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


def test_what_was_edited_in_the_file_is_kept(folder, modules, capsys):
    for number in (1, 2):
        (modules / 'greeter.py').write_text(f'edited {number}')
        node_file.write_node('greeter.py', NODE)
        assert (folder / f'kept/greeter_{number}.py').read_text() == f'edited {number}'
        assert f'moved    $ROS_WS/kept/greeter_{number}.py: ' in capsys.readouterr().out
        assert (modules / 'greeter.py').read_text() == NODE
    assert (folder / 'kept/COLCON_IGNORE').is_file()


@pytest.mark.parametrize('name', ['', 'greeter', 'my node.py', '../greeter.py', '/tmp/greeter.py'])
def test_what_is_no_name_of_a_module_is_refused(modules, name):
    before = sorted(modules.iterdir())
    with pytest.raises(node_file.NotWritten, match='expected a name such as'):
        node_file.write_node(name, NODE)
    assert sorted(modules.iterdir()) == before


def test_without_a_workspace_it_names_the_cell_to_run(folder):
    with pytest.raises(node_file.NotWritten, match=r'run the cell with make_workspace\(\) first'):
        node_file.write_node('greeter.py', NODE)


def test_the_tree_shows_what_is_there_and_which_files_are_the_students(folder, modules, capsys):
    node_file.write_node('greeter.py', NODE)
    (folder / 'build').mkdir()
    capsys.readouterr()
    node_file.show_workspace()
    lines = [re.search(r'[\w$./]+', line)[0] for line in capsys.readouterr().out.splitlines()]
    package = ['my_robot_basics/', 'package.xml', 'setup.py', 'my_robot_basics/', 'greeter.py']
    assert lines == ['$ROS_WS/', 'src/', *package, 'build/']
