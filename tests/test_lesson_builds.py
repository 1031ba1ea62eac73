"""Lesson 10 on building interfaces: with a compiler, without one, and the need of each line."""

import shutil
import sys
from pathlib import Path

import nbformat
import pytest
from colcon_terminal import bash
from fresh_machine import programs_without_compilers
from my_robot_basics.live.packages import workspace
from my_robot_basics.session import build_tools

ROOT = Path(__file__).parents[1]
LESSON = nbformat.read(ROOT / 'solutions/10_interfaces/10_interfaces.ipynb', as_version=4)
CELLS = {cell.id: cell.source for cell in LESSON.cells}
BUILD = CELLS['build'].partition('\n')[2]
"""The cell without its %%bash."""
HASH = 'RIHS01_a0e25369'
"""As both cells print it: the same with a compiler and without."""
GROUP = '  <member_of_group>rosidl_interface_packages</member_of_group>\n'
FILES = '  "msg/Turns.msg"\n  "srv/CountTurns.srv"\n'

with_a_compiler = pytest.mark.skipif(
    bool(build_tools.missing_programs()), reason='there is no compiler, or no CMake'
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A workspace with the course's packages in it."""
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path / 'ws'))
    assert workspace.main([]) is None
    return tmp_path / 'ws'


def outputs(cell_id):
    released = nbformat.read(
        ROOT / 'notebooks/10_interfaces/10_interfaces.ipynb', as_version=4
    ).cells
    (cell,) = (cell for cell in released if cell.id == cell_id)
    text = ''.join(output.text for output in cell.outputs)
    return text.replace('\r', '')  # a command's end of line in a notebook


@pytest.mark.starts
def test_the_build_cell_reports_a_missing_compiler_and_continues(folder, tmp_path):
    programs = programs_without_compilers(tmp_path / 'programs')
    said = bash(folder, BUILD, PATH=f'{sys.prefix}/bin:{programs}').stdout
    assert f'{workspace.INTERFACES} cannot be built on this machine: ' in said
    assert 'sudo apt install build-essential cmake' in said
    assert said.endswith(f'in use: {sys.prefix}/share/{workspace.INTERFACES}\n{HASH}\n')


def test_the_stored_outputs_are_those_of_a_machine_with_a_compiler():
    assert outputs('build').endswith(
        f'in use: $ROS_WS/install/{workspace.INTERFACES}/share/{workspace.INTERFACES}\n{HASH}\n'
    )
    assert outputs('same') == f'{HASH}\n'


@pytest.mark.slow
@with_a_compiler
def test_the_build_cell_uses_its_own_build_if_there_is_a_compiler(folder):
    said = bash(folder, BUILD).stdout
    lines = said.splitlines()
    assert 'Summary: 1 package finished' in said
    assert lines[-2:] == outputs('build').splitlines()[-2:]


@pytest.mark.slow
@with_a_compiler
def test_the_answer_of_lesson_10_builds_and_each_of_its_lines_is_needed(folder):
    """Lesson 10's table: CMake refuses without the group; a file that is not named is missing."""
    package = make_package(folder)
    xml, cmake = package / 'package.xml', package / 'CMakeLists.txt'
    build = 'colcon build --packages-select turn_interfaces'

    whole = xml.read_text()
    xml.write_text(whole.replace(GROUP, ''))
    refused = bash(folder, build)
    assert 'Packages installing interfaces must include' in refused.stdout
    assert 'Failed   <<< turn_interfaces' in refused.stdout
    xml.write_text(whole)

    listed = cmake.read_text()
    cmake.write_text(listed.replace('  "srv/CountTurns.srv"\n', ''))
    show = '. install/setup.bash && ros2 interface package turn_interfaces'
    assert bash(folder, f'{build} && {show}').stdout.endswith(']\nturn_interfaces/msg/Turns\n')
    cmake.write_text(listed)
    both = 'turn_interfaces/msg/Turns\nturn_interfaces/srv/CountTurns\n'
    assert bash(folder, f'{build} && {show}').stdout.endswith(f']\n{both}')

    program = (
        'from rclpy.serialization import deserialize_message, serialize_message\n'
        'from turn_interfaces.srv import CountTurns as C\n'
        'response = C.Response(success=True, each_second=[3, -2])\n'
        'back = deserialize_message(serialize_message(response), C.Response)\n'
        'print(back.success, list(back.each_second), back.total.gear_ratios.tolist())\n'
        'print(type(back.total).MOTOR2, C.Request().duration)\n'
    )
    done = bash(folder, f". install/setup.bash && python -c '{program}'")
    assert done.stdout == (
        'True [3, -2] [100.0, 50.0]\n1 builtin_interfaces.msg.Duration(sec=0, nanosec=0)\n'
    )


def make_package(folder):
    """Write the lesson's own answer as the lesson says: a package like arm_interfaces."""
    answer = {}
    exec(CELLS['count_turns'], answer)
    package = folder / 'src/turn_interfaces'
    shutil.copytree(folder / 'src/arm_interfaces', package)
    shutil.rmtree(package / 'action')
    for path, text in {
        'msg/Turns.msg': answer['turns_msg'],
        'srv/CountTurns.srv': answer['count_turns_srv'],
    }.items():
        (package / path).parent.mkdir(exist_ok=True)
        (package / path).write_text(text)
    (package / 'srv/SolveIK.srv').unlink()
    for name in ('package.xml', 'CMakeLists.txt'):
        text = (package / name).read_text().replace('arm_interfaces', 'turn_interfaces')
        text = text.replace('<depend>geometry_msgs</depend>', NEEDED).replace(
            'find_package(geometry_msgs REQUIRED)', FOUND
        )
        text = text.replace(
            'DEPENDENCIES geometry_msgs', 'DEPENDENCIES std_msgs builtin_interfaces'
        )
        text = text.replace('  "srv/SolveIK.srv"\n  "action/MoveArm.action"\n', FILES)
        (package / name).write_text(text)
    return package


NEEDED = '<depend>std_msgs</depend>\n  <depend>builtin_interfaces</depend>'
FOUND = 'find_package(std_msgs REQUIRED)\nfind_package(builtin_interfaces REQUIRED)'
