"""The launcher, before anything is installed: its verbs, the environment, the installer."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import ros_wheels_bootstrapper

from grader.cli.arguments import make_parser
from grader.course import ROOT
from launcher.environment import Environment, without_foreign
from launcher.installer import DISK_IS_FULL, FAILED, NETWORK_IS_AWAY, reason_of, step_of
from launcher.main import run_verb
from launcher.set_up import BUILD_TOOLS, build_tools
from launcher.shares import executables_of
from launcher.verbs import read_verbs


def test_a_row_of_the_table_of_verbs_has_owner_module_folder_and_help():
    verbs = read_verbs()
    grade = verbs['grade']
    assert (grade.owner, grade.runs, grade.folder) == ('course', 'grader grade', 'root')
    assert grade.help.startswith('grade what is new in gradebook/submitted/')
    assert [verb.name for verb in verbs.values() if verb.owner == 'everyone'] == [
        *('lab', 'validate', 'progress', 'workspace', 'ros-shell', 'wheels', 'hub')
    ]


def test_the_grader_has_the_verbs_that_the_table_says_it_has():
    (choices,) = (action.choices for action in make_parser()._actions if action.choices)
    said = [verb.runs for verb in read_verbs().values() if verb.runs.startswith('grader ')]
    assert sorted(said) == sorted(f'grader {name}' for name in choices)


@pytest.mark.parametrize(
    'row', ['nobody|launcher.lab|root|lab  open', 'everyone|launcher.lab|home|lab  open']
)
def test_a_wrong_row_in_the_table_of_verbs_is_refused(row, tmp_path):
    table = tmp_path / 'verbs.txt'
    table.write_text(f'# the verbs\n{row}\n')
    with pytest.raises(ValueError, match=re.escape(row)):
        read_verbs(table)


def test_a_new_verb_needs_only_one_row_in_the_table_of_verbs(tmp_path):
    shutil.copy(ROOT / 'course', tmp_path)
    shutil.copytree(ROOT / 'launcher', tmp_path / 'launcher')
    with (tmp_path / 'launcher/verbs.txt').open('a') as table:
        table.write('everyone|launcher.wave|root|wave NAME          say hello\n')
    usage = subprocess.run([tmp_path / 'course', '--help'], capture_output=True, text=True)
    assert '  wave NAME          say hello\n' in usage.stdout
    assert read_verbs(tmp_path / 'launcher/verbs.txt')['wave'].help == 'say hello'


def test_the_launcher_imports_only_the_standard_library():
    code = (
        f'import sys; sys.path.append({str(ROOT)!r})\n'
        'from launcher import lab, main, testing\n'
        'names = {name.partition(".")[0] for name in sys.modules} - {"__main__", "launcher"}\n'
        'print(sorted(names - sys.stdlib_module_names))\n'
    )
    command = ['sh', '-c', 'exec "$@"', 'sh', sys._base_executable, '-ISc', code]
    run = subprocess.run(command, capture_output=True, text=True)
    assert (run.stdout, run.stderr) == ('[]\n', '')


@pytest.mark.parametrize(
    ('folders', 'kept'),
    [
        ('/usr/bin:/opt/ros/jazzy/bin:/opt/rosy', '/usr/bin:/opt/rosy'),
        ('/opt/ros', ''),
        ('', ''),
        ('::/usr/bin:', '/usr/bin'),
        ('/home/ada/ros ws/bin/', ''),
    ],
)
def test_folders_of_other_environments_are_left_out(folders, kept):
    assert without_foreign(folders, {'/opt/ros', '/home/ada/ros ws'}) == kept


def test_a_workspace_chosen_by_the_caller_is_kept_in_the_environment():
    environment = Environment(Path('/course'))
    inside = environment.variables({'PATH': '/bin', 'MY_ROBOT_BASICS_WORKSPACE': '/mine'})
    assert inside['ROS_WS'] == '/mine'
    assert inside['PATH'] == '/course/.venv/bin:/bin'
    assert 'COLCON_PYTHON_EXECUTABLE' not in inside


def test_a_verb_gets_the_libraries_of_ros_and_starts_once(monkeypatch):
    monkeypatch.setenv('LD_LIBRARY_PATH', '/usr/local/cuda/lib64')
    run = []
    monkeypatch.setattr(os, 'execve', lambda *arguments: run.append(arguments))
    monkeypatch.setattr(sys, 'executable', f'{ROOT}/.venv/bin/python')
    monkeypatch.chdir(ROOT)  # run_verb changes it
    run_verb(Environment(ROOT), read_verbs()['due'], [])
    ((python, command, variables),) = run
    assert python == command[0] == sys.executable
    assert variables['_ROS_WHEELS_BOOTSTRAP_COMPLETE'] == '1'
    folders = variables['LD_LIBRARY_PATH'].split(':')
    assert folders[-1] == '/usr/local/cuda/lib64'
    assert sorted(folders) == sorted(ros_wheels_bootstrapper.get_ros_paths().split(':'))


def test_the_python_of_a_new_venv_looks_for_the_libraries_of_ros_itself(monkeypatch):
    run = []
    monkeypatch.setattr(os, 'execve', lambda *arguments: run.append(arguments))
    # the launcher's Python, which may have another version than that of .venv
    monkeypatch.setattr(sys, 'executable', '/usr/bin/python3')
    monkeypatch.chdir(ROOT)
    run_verb(Environment(ROOT), read_verbs()['due'], [])
    assert '_ROS_WHEELS_BOOTSTRAP_COMPLETE' not in run[0][2]


@pytest.mark.parametrize(
    ('line', 'step'),
    [
        ('Collecting six==1.17.0 (from -r environment.txt (line 7))', 'Collecting six==1.17.0'),
        ('Installing collected packages: six, pip', 'Installing'),
        ('Using CPython 3.12.1', ''),
    ],
)
def test_the_steps_of_an_installer_are_shown(line, step):
    assert step_of(line) == step


def test_a_full_disk_is_the_reported_reason_even_with_network_errors():
    assert reason_of(['Max retries exceeded', 'No space left on device']) == DISK_IS_FULL
    assert reason_of(['x', 'error: Failed to fetch: `https://…`']) == NETWORK_IS_AWAY


def test_only_the_last_lines_of_an_unknown_failure_are_shown():
    lines = [f'line {number}' for number in range(30)]
    assert reason_of(lines).split('\n') == [*lines[10:], FAILED]


def test_the_executables_are_those_of_setup_py():
    setup = "    'a_node = my_robot_basics.a_node:main',\n    'other = elsewhere.other:main',\n"
    assert executables_of(setup) == ['a_node']


def test_every_package_without_a_wheel_is_built_with_tools_that_are_pinned():
    """pip's own environments for builds take no hashes: on an empty cache, it failed."""
    pins = build_tools(ROOT / 'environment.txt')
    assert [line.split('==')[0] for line in pins.splitlines()[::2]] == list(BUILD_TOOLS)
    assert pins.count('--hash=sha256:') >= len(BUILD_TOOLS)
