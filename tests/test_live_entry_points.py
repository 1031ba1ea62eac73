"""An entry point goes into the student's setup.py, and nothing else there changes."""

import ast

import pytest
from my_robot_basics.live.packages.entry_points import NotAdded, add_entry_point
from my_robot_basics.live.packages.workspace import make_workspace

LINE = 'greeter = my_robot_basics.greeter:main'


@pytest.fixture
def package(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path / 'ros ws'))
    make_workspace()
    package = tmp_path / 'ros ws/src/my_robot_basics'
    (package / 'my_robot_basics/greeter.py').write_text('def main():\n    pass\n')
    capsys.readouterr()
    return package


@pytest.fixture
def setup_file(package):
    return package / 'setup.py'


def scripts(setup_file):
    for node in ast.walk(ast.parse(setup_file.read_text())):
        if isinstance(node, ast.Dict) and node.keys[0].value == 'console_scripts':
            return ast.literal_eval(node.values[0])


def refusal(entry_point=LINE):
    with pytest.raises(NotAdded) as caught:
        add_entry_point(entry_point)
    return str(caught.value)


def test_an_entry_point_is_added_first_and_the_rest_of_setup_py_is_unchanged(setup_file, capsys):
    before, listed = setup_file.read_text(), scripts(setup_file)
    add_entry_point(LINE)
    assert scripts(setup_file) == [LINE, *listed]
    assert setup_file.read_text().replace(f"            '{LINE}',\n", '') == before
    said = capsys.readouterr().out.splitlines()
    assert said[0] == f"added    '{LINE}' in $ROS_WS/src/my_robot_basics/setup.py:"
    assert said[1:3] == ["'console_scripts': [", f"    '{LINE}',"]
    assert said[-2:] == [f'    {listed[-1]!r},', ']']


def test_adding_an_entry_point_again_changes_nothing(setup_file, capsys):
    add_entry_point(LINE)
    once = setup_file.read_text()
    capsys.readouterr()
    add_entry_point(LINE)
    assert setup_file.read_text() == once
    assert capsys.readouterr().out.startswith(f"kept     '{LINE}'")


@pytest.mark.parametrize(
    'listed', ["['a = b:c', 'd = e:f']", '[]', "[\n  'a = b:c']", "['ä = b:c',\n 'd = e:f',\n]"]
)
def test_an_entry_point_is_added_to_a_list_of_any_form(setup_file, listed):
    text = (
        f"# mine\nsetup(x='ü', entry_points={{'console_scripts': {listed}}}, y=1)  # mine, too\n"
    )
    setup_file.write_text(text)
    add_entry_point(LINE)
    assert scripts(setup_file) == [LINE, *ast.literal_eval(listed)]
    after = setup_file.read_text()
    assert after.startswith("# mine\nsetup(x='ü'")
    assert after.endswith('}, y=1)  # mine, too\n')


def test_an_entry_point_of_the_same_name_is_left_alone_and_reported(setup_file):
    text = setup_file.read_text().replace('hello_node =', 'greeter =')
    setup_file.write_text(text)
    assert refusal().startswith(
        "setup.py has another line for greeter: 'greeter = my_robot_basics.hello_node:main'"
    )
    assert setup_file.read_text() == text


def test_a_setup_py_without_console_scripts_is_left_alone_and_reported(setup_file):
    setup_file.write_text('from setuptools import setup\n')
    assert f"has no list 'console_scripts' any more: add '{LINE}' yourself" in refusal()
    assert setup_file.read_text() == 'from setuptools import setup\n'


@pytest.mark.parametrize('name', ['setup.py', 'my_robot_basics/greeter.py'])
def test_a_file_that_is_not_valid_python_is_reported_with_the_line(package, name):
    (package / name).write_text('x = 1\ndef main(:\n')
    assert f'{name} is not valid Python (line 2: ' in refusal()


def test_a_missing_module_is_reported_with_the_cell_that_writes_it(package, setup_file, capsys):
    before = setup_file.read_text()
    (package / 'my_robot_basics/greeter.py').unlink()
    add_entry_point(LINE)
    said = ' '.join(capsys.readouterr().out.split())
    assert said.startswith('not added: there is no $ROS_WS/src/my_robot_basics/my_robot_basics/')
    assert said.endswith('greeter.py yet: run the cell with %%write_node greeter.py first')
    assert setup_file.read_text() == before


def test_a_missing_function_is_reported(package):
    (package / 'my_robot_basics/greeter.py').write_text('def start():\n    pass\n')
    assert 'greeter.py has no function main: write it there' in refusal()


def test_the_error_without_a_workspace_names_the_cell_to_run(package, setup_file):
    setup_file.unlink()
    assert refusal().endswith('run the cell with make_workspace() first')


@pytest.mark.parametrize('line', ['', 'greeter', 'greeter = other.greeter:main', "a' = b.c:d"])
def test_a_text_that_is_not_an_entry_point_of_the_package_is_refused(package, line):
    assert refusal(line).startswith("expected an entry point such as 'greeter = ")
