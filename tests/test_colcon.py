"""`colcon build` of the interfaces: a real build, and one sentence if there is no compiler."""

import json
import shutil
import sys
import sysconfig
from pathlib import Path

import pytest
from colcon_terminal import bash
from fresh_machine import programs_without_compilers
from my_robot_basics.live.packages import workspace
from my_robot_basics.session import build_tools
from ros2_command import NODES, own_domain

ROOT = Path(__file__).parents[1]
NAME = workspace.INTERFACES
COMPILED = ('srv/SolveIK', 'action/MoveArm')
BUILD = f'colcon build --packages-select {NAME}'
PYTHON_DEV = 'python{}.{}-dev'.format(*sys.version_info)
INSTEAD = f'; until then, the {NAME} that the course has installed goes on working'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A workspace with the package in it."""
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path / 'ros ws'))
    assert workspace.main([]) is None
    return tmp_path / 'ros ws'


# --- without a compiler --------------------------------------------------------------------------


def lacking(names, *packages):
    """Return the whole sentence about what is missing."""
    return (
        f'{NAME} cannot be built on this machine: {names} missing; to get what is missing on '
        f'Debian and Ubuntu: sudo apt install {" ".join(packages)}{INSTEAD}'
    )


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """A machine without those programs that build others, until a test puts one there."""
    programs = programs_without_compilers(tmp_path / 'programs')
    monkeypatch.setenv('PATH', str(programs))
    for name in ('CC', 'CXX', 'CMAKE_COMMAND'):
        monkeypatch.delenv(name, raising=False)

    def add(*names):
        for name in names:
            (programs / name).write_text('#!/bin/sh\n')
            (programs / name).chmod(0o755)

    return add


@pytest.mark.slow
@pytest.mark.starts
def test_colcon_reports_a_missing_compiler_in_one_sentence(folder, programs):
    done = bash(folder, BUILD)
    assert done.returncode == 1
    sentence = lacking('gcc, g++, make and cmake are', 'build-essential', 'cmake')
    skip = f'colcon build --packages-skip {NAME}'
    started, heading, said, rule, failed, *_ = done.stdout.splitlines()
    assert started == f'Starting >>> {NAME}'
    assert (heading, rule) == (f'--- stderr: {NAME}', '---')
    assert said == f'{sentence}; what needs no compiler is built with: {skip}'
    assert failed.startswith(f'Failed   <<< {NAME} ')
    assert not (folder / 'install' / NAME / 'share/ament_index').exists()
    others = bash(folder, skip)
    assert 'Summary: 1 package finished' in others.stdout, others.stdout


def test_making_the_workspace_reports_missing_build_tools_before_a_build(folder, programs, capsys):
    workspace.main([])
    *_, last = capsys.readouterr().out.splitlines()
    assert last == lacking('gcc, g++, make and cmake are', 'build-essential', 'cmake')


def test_installed_build_tools_are_not_reported_as_missing(programs):
    programs('cc', 'c++', 'make')
    assert build_tools.build_problem(NAME) == lacking('cmake is', 'cmake')
    programs('cmake')
    assert build_tools.build_problem(NAME) == ''


def test_a_compiler_with_an_alternative_name_counts_but_a_missing_one_does_not(
    programs, monkeypatch
):
    programs('clang', 'clang++', 'gmake', 'cmake')
    assert build_tools.build_problem(NAME) == ''
    monkeypatch.setenv('CC', 'ccache gcc')
    assert build_tools.build_problem(NAME) == lacking('gcc is', 'build-essential')


def test_missing_python_headers_are_reported_with_their_package(programs, tmp_path, monkeypatch):
    programs('cc', 'c++', 'make', 'cmake')
    monkeypatch.setattr(sysconfig, 'get_path', lambda name: str(tmp_path / name))
    version = '{}.{}'.format(*sys.version_info)
    assert build_tools.build_problem(NAME) == lacking(
        f'Python.h of Python {version} is', PYTHON_DEV
    )


def test_no_installed_copy_is_promised_for_a_package_that_is_not_installed(programs):
    assert 'until then' not in build_tools.build_problem('own_interfaces')


# --- the interfaces in the workspace -------------------------------------------------------------


def test_the_workspace_gets_the_sources_of_the_interfaces_but_no_wheel(folder):
    copied = folder / 'src' / NAME
    files = {str(path.relative_to(copied)) for path in copied.rglob('*') if path.is_file()}
    assert files == {'package.xml', 'CMakeLists.txt', 'srv/SolveIK.srv', 'action/MoveArm.action'}
    for file in files:
        assert (copied / file).read_bytes() == (ROOT / NAME / file).read_bytes()


def test_make_workspace_copies_no_interfaces_by_default(folder, capsys):
    shutil.rmtree(folder / 'src')
    workspace.make_workspace()
    assert [path.name for path in (folder / 'src').iterdir()] == ['my_robot_basics']
    assert NAME not in capsys.readouterr().out


def test_refreshing_one_package_leaves_the_nodes_package_unchanged(folder, capsys):
    definition, nodes = folder / f'src/{NAME}/srv/SolveIK.srv', folder / 'src/my_robot_basics'
    definition.write_text('mine')
    (nodes / 'setup.py').write_text('mine')
    assert workspace.main(['--refresh', NAME]) is None
    assert definition.read_bytes() == (ROOT / NAME / 'srv/SolveIK.srv').read_bytes()
    assert (folder / f'kept/{NAME}_1/srv/SolveIK.srv').read_text() == 'mine'
    assert (nodes / 'setup.py').read_text() == 'mine'
    assert f'moved    $ROS_WS/kept/{NAME}_1: ' in capsys.readouterr().out


def test_the_cmake_files_of_ros_name_no_folder_of_another_machine():
    exports = sorted(Path(sys.prefix).glob('share/*/cmake/*__rosidl_generator_pyExport.cmake'))
    assert len(exports) >= 20
    assert [file.name for file in exports if '/opt/python' in file.read_text()] == []


# --- with a compiler -----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.skipif(
    bool(build_tools.missing_programs()), reason='there is no compiler, or no CMake'
)
def test_interfaces_built_by_colcon_are_interchangeable_with_the_wheel(folder, capsys):
    """One build serves all of these assertions: it takes 15 s of both cores."""
    built = bash(folder, BUILD)
    assert 'Summary: 1 package finished' in built.stdout, built.stdout
    assert 'stderr' not in built.stdout  # CMake had nothing to say

    # one and the same definition for ROS: type hashes, and what `ros2` shows
    install = folder / 'install' / NAME
    for name in COMPILED:
        file = Path('share', NAME, name).with_suffix('.json')
        theirs, ours = (
            json.loads((root / file).read_text()) for root in (install, Path(sys.prefix))
        )
        assert theirs['type_hashes'] == ours['type_hashes']
        assert all(each['hash_string'].startswith('RIHS01_') for each in ours['type_hashes'])

    source = '. install/setup.bash\n'
    own = folder / f'src/{NAME}/srv/SolveIK.srv'
    shown = bash(folder, f'{source}ros2 interface show {NAME}/srv/SolveIK; ros2 pkg prefix {NAME}')
    assert shown.stdout.endswith(f'\n{install}\n')
    assert shown.stdout.startswith(own.read_text().splitlines()[0])

    # each type makes a round trip, and a server with the wheel answers a client with the build
    imported = f'python -c "import {NAME}.srv; print({NAME}.__file__)"\n'
    program = f'python -P {ROOT / "tests/round_trip.py"}\n'
    with own_domain():
        went = bash(folder, source + imported + program)
        assert went.stdout.splitlines()[-2:] == ['SolveIK', 'MoveArm'], went.stdout
        assert Path(went.stdout.splitlines()[0]).is_relative_to(install)
        request = "'{target: {x: 0.5, y: 0.3}}'"
        called = bash(
            folder,
            # the server has the wheel, and the client the build
            f'python {NODES}/ik_service.py & server=$!\n{source}'
            f'timeout 60 ros2 service call /solve_ik {NAME}/srv/SolveIK {request}\n'
            'kill $server; wait $server 2>kill.txt\n',
            PYTHONPATH='',
        )
    assert 'reachable=True' in called.stdout, called.stdout

    # a build that is older than its sources is reported
    capsys.readouterr()
    workspace.main([])
    assert f'{NAME} is built' in capsys.readouterr().out
    own.write_text(own.read_text() + '# mine\n')
    workspace.main([])
    assert 'was built before srv/SolveIK.srv in src was changed' in capsys.readouterr().out
