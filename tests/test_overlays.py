"""Interface packages that a workspace has built: which one is used, how faults are reported.

The package in these tests is the course's wheel, laid out as by colcon; test_colcon.py builds one.
"""

import json
import os
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest
from my_robot_basics.session import overlays, sourced, sourced_workspaces
from ros2_command import SCRIPT, own_domain, ros2, started

ROOT = Path(__file__).parents[1]
NAME = 'arm_interfaces'
PYTHON = 'python{}.{}'.format(*sys.version_info)
OTHER = 'python3.10'
MODULES = f'lib/{PYTHON}/site-packages/{NAME}'
DEFINITION = f'share/{NAME}/srv/SolveIK.srv'
PATIENCE_SEC = 60
MAPPED = f"""
from rclpy.serialization import serialize_message
from {NAME}.srv import SolveIK
serialize_message(SolveIK.Request())  # the last of the libraries are loaded by name, only now
files = [line.split(maxsplit=5)[5:] for line in open('/proc/self/maps')]
print(*sorted({{file.strip() for file, in filter(None, files) if '{NAME}' in file}}), sep='\\n')
"""


class Built:
    """A workspace in which the package was built, and a terminal that has sourced it."""

    def __init__(self, workspace, merged=False):
        self.workspace = workspace
        self.prefix = workspace / ('install' if merged else f'install/{NAME}')
        self.modules = self.prefix / MODULES
        for name in ('package.xml', 'srv', 'action'):
            copy = shutil.copy if '.' in name else shutil.copytree
            (workspace / 'src' / NAME).mkdir(parents=True, exist_ok=True)
            copy(ROOT / NAME / name, workspace / 'src' / NAME / name)
        installed = metadata.distribution(NAME)
        for file in installed.files:
            source = Path(installed.locate_file(file)).resolve()
            target = self.prefix / source.relative_to(sys.prefix)
            if '.dist-info' not in str(file) and '__pycache__' not in str(file):
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, target)
        (module,) = self.modules.glob('*.abi3.so')
        module.rename(module.with_name(module.name.replace('.abi3', '')))
        libraries = self.prefix / 'lib'
        shutil.copy(
            libraries / f'lib{NAME}__rosidl_generator_c.so',
            libraries / f'lib{NAME}__rosidl_generator_py.so',
        )
        (workspace / 'install/.colcon_install_layout').write_text(
            'merged\n' if merged else 'isolated\n'
        )

    def variables(self, version=PYTHON):
        """The environment variables that its setup.bash sets."""
        clean = {
            name: value
            for name, value in os.environ.items()
            if name not in ('LD_LIBRARY_PATH', '_ROS_WHEELS_BOOTSTRAP_COMPLETE')
        }
        return clean | {
            'AMENT_PREFIX_PATH': f'{self.prefix}:{sys.prefix}',
            'PYTHONPATH': f'{self.prefix}/lib/{version}/site-packages',
            'LD_LIBRARY_PATH': f'{self.prefix}/lib',
            'ROS_WS': str(self.workspace),
        }

    def python(self, code, **variables):
        return subprocess.run(
            [sys.executable, '-P', '-c', code],
            env=self.variables() | variables,
            capture_output=True,
            text=True,
            timeout=PATIENCE_SEC,
        )

    def shown(self):
        """What `ros2 interface show` answers, without the tests' own libraries."""
        return ros2('interface', 'show', f'{NAME}/srv/SolveIK', **self.variables())

    def again(self, folders=f'build/{NAME} install/{NAME}', option=''):
        """The remedy that each error and warning ends with."""
        return (
            f': build it again, with `cd "$ROS_WS" && rm -rf {folders} && colcon build {option}'
            f'--packages-select {NAME} && source install/setup.bash`'
        )


@pytest.fixture
def built(tmp_path):
    return Built(tmp_path / 'ros ws')


def error_of_import(built, **variables):
    """The error of an import, which is also that of `ros2`."""
    imported = built.python(f'import {NAME}.srv', **variables)
    assert imported.returncode == 1, imported.stdout
    kind, _, sentence = imported.stderr.splitlines()[-1].partition(': ')
    assert kind == 'ImportError'
    shown = ros2('interface', 'show', f'{NAME}/srv/SolveIK', **built.variables() | variables)
    assert shown.err.splitlines()[0] == f'course: {sentence}'
    beginning = f'{NAME} in {built.prefix} '
    assert sentence.startswith(beginning)
    return sentence.removeprefix(beginning)


# --- which package is used -----------------------------------------------------------------------


@pytest.mark.starts
@pytest.mark.parametrize('seed', range(6))
def test_all_libraries_of_a_package_are_loaded_from_the_workspace(built, seed):
    # ROS's wheels put the folders of libraries into a set, whose order goes by this seed
    loaded = built.python(MAPPED, PYTHONHASHSEED=str(seed))
    assert (loaded.returncode, loaded.stderr) == (0, '')
    files = [Path(line) for line in loaded.stdout.splitlines()]
    assert len(files) >= 4
    assert [file for file in files if not file.is_relative_to(built.prefix)] == []


@pytest.mark.starts
def test_ros2_shows_a_sound_package_of_the_workspace_without_a_warning(built):
    for file in (built.prefix / DEFINITION, built.workspace / f'src/{NAME}/srv/SolveIK.srv'):
        file.write_text(file.read_text() + '# mine\n')
    assert built.shown().out.endswith('# mine\n')
    assert built.shown().err == ''


@pytest.mark.starts
def test_the_libraries_of_a_robots_ros_stay_behind_those_of_the_wheels(built, tmp_path):
    robot = tmp_path / 'opt/ros/jazzy/lib'
    robot.mkdir(parents=True)
    order = built.python(
        'import os; print(os.environ["LD_LIBRARY_PATH"])',
        LD_LIBRARY_PATH=f'{robot}:{built.prefix}/lib',
    ).stdout.split(':')
    assert order[:2] == [f'{built.prefix}/lib', f'{sys.prefix}/lib']
    assert order[-1].rstrip() == str(robot)


def test_the_check_of_packages_runs_before_the_wheels_restart_python():
    (packages,) = Path(sys.prefix).glob('lib/python*/site-packages')
    names = sorted(file.name for file in packages.glob('*.pth'))  # site reads them in this order
    ours, theirs = 'my_robot_basics_sourced.pth', 'ros_wheels_bootstrapper.pth'
    assert names.index(ours) < names.index(theirs)


# --- faults of a built package -------------------------------------------------------------------


@pytest.mark.starts
def test_a_package_built_for_another_python_is_reported(built):
    (built.prefix / 'lib' / PYTHON).rename(built.prefix / 'lib' / OTHER)
    variables = {'PYTHONPATH': built.variables(OTHER)['PYTHONPATH']}
    this = PYTHON.removeprefix('python')
    assert error_of_import(built, **variables) == (
        f'was built for Python 3.10, and this is Python {this}{built.again()}'
    )


@pytest.mark.starts
@pytest.mark.parametrize(
    'file',
    [
        f'lib/lib{NAME}__rosidl_typesupport_fastrtps_c.so',
        f'{MODULES}/{NAME}_s__rosidl_typesupport_c.so',
        f'{MODULES}/srv/__init__.py',
        DEFINITION,
    ],
)
def test_a_half_built_package_is_reported_with_the_missing_file(built, file):
    (built.prefix / file).unlink()
    if file.startswith(MODULES) and file.endswith('.so'):
        (built.modules / f'_{NAME}_s.ep.rosidl_typesupport_c.c').touch()  # colcon leaves it there
    assert error_of_import(built) == f'is only half built, without {file}{built.again()}'


@pytest.mark.starts
def test_a_truncated_library_is_reported(built):
    file = f'lib/lib{NAME}__rosidl_typesupport_c.so'
    (built.prefix / file).write_bytes(b'')
    assert (
        error_of_import(built)
        == f'is only half built: {file} is empty or cut short{built.again()}'
    )


@pytest.mark.starts
def test_a_half_built_package_in_a_merged_workspace_is_reported(tmp_path):
    built = Built(tmp_path / 'ros_ws', merged=True)
    (built.prefix / DEFINITION).unlink()
    again = built.again('build install', '--merge-install ')
    assert error_of_import(built) == f'is only half built, without {DEFINITION}{again}'


@pytest.mark.starts
def test_a_ros2_command_that_needs_a_half_built_package_ends_with_the_error(built):
    (built.prefix / f'lib/lib{NAME}__rosidl_generator_c.so').unlink()
    call = ros2('service', 'call', '/solve_ik', f'{NAME}/srv/SolveIK', **built.variables())
    sentence, *rest = call.err.splitlines()
    assert (call.status, call.out) == (1, '')
    assert 'is only half built' in sentence
    assert rest == [f'{NAME}/srv/SolveIK cannot be loaded, for the reason above']


def warning_of_import(built):
    """The warning of an import that succeeds, which is also that of `ros2`."""
    imported = built.python(f'import {NAME}.srv; print({NAME}.__file__)')
    assert Path(imported.stdout.strip()) == built.modules / '__init__.py'
    assert imported.stderr == built.shown().err
    assert built.shown().status == 0
    beginning = f'course: {NAME} in {built.prefix} '
    assert imported.stderr.startswith(beginning)
    return imported.stderr.removeprefix(beginning).removesuffix('\n')


@pytest.mark.starts
def test_a_package_older_than_its_sources_is_reported(built):
    (built.workspace / f'src/{NAME}/srv/SolveIK.srv').write_text('float64 x\n---\n')
    assert warning_of_import(built) == (
        f'was built before srv/SolveIK.srv in src was changed{built.again()}'
    )


@pytest.mark.starts
def test_an_interface_that_differs_from_the_courses_is_reported(built):
    file = built.prefix / f'share/{NAME}/srv/SolveIK.json'
    described = json.loads(file.read_text())
    for each in described['type_hashes']:
        each['hash_string'] = 'RIHS01_' + 64 * '0'
    file.write_text(json.dumps(described))
    said = warning_of_import(built)
    assert said.startswith('has another srv/SolveIK.srv than the course, so nodes that use it ')
    assert f'(./course workspace --refresh {NAME})' in said


def test_a_package_that_the_course_does_not_have_is_not_compared(built):
    own = overlays.Overlay(built.prefix, NAME)
    assert own.difference() == ''
    for folder in ('share', 'lib'):
        for path in sorted(built.prefix.glob(f'{folder}/**/*{NAME}*'), reverse=True):
            path.rename(path.with_name(path.name.replace(NAME, 'own_interfaces')))
    assert overlays.Overlay(built.prefix, 'own_interfaces').difference() == ''


@pytest.mark.starts
def test_a_missing_install_folder_is_reported_and_the_courses_package_is_used(built):
    shutil.rmtree(built.workspace / 'install')
    sentence = (
        f'{built.prefix} is gone, and this terminal still looks for its package there: build the '
        "package again, or open a new terminal, which uses the course's package if there is one"
    )
    imported = built.python(f'import {NAME}; print({NAME}.__file__)')
    assert imported.stdout.strip().startswith(sys.prefix)
    assert imported.stderr == f'course: {sentence}\n'
    assert built.shown().err == f'course: {sentence}\n'
    assert 'float64[] elbow_up' in built.shown().out  # that of the course
    folder = built.prefix.with_name('own_interfaces')
    missing = built.python(
        'import own_interfaces', PYTHONPATH=f'{folder}/lib/{PYTHON}/site-packages'
    )
    assert missing.stderr.splitlines()[-1] == (
        'ModuleNotFoundError: ' + sentence.replace(str(built.prefix), str(folder))
    )


def test_an_unreadable_install_folder_is_reported(tmp_path, monkeypatch):
    def refuse(path):
        raise PermissionError(13, 'Permission denied', str(path))

    monkeypatch.setattr(os, 'listdir', refuse)
    monkeypatch.setattr(os, 'access', lambda path, mode: False)
    (said,) = sourced_workspaces.faults({'AMENT_PREFIX_PATH': str(tmp_path)})
    assert said.startswith(f'{tmp_path} cannot be read ([Errno 13] Permission denied: ')
    assert 'get the right to read it (`ls -ld` shows whose it is), or open a new' in said


@pytest.mark.starts
def test_packages_that_belong_to_the_robot_are_not_checked(built):
    (built.workspace / 'install/.colcon_install_layout').unlink()  # as in /opt/ros
    (built.prefix / DEFINITION).unlink()
    assert ros2('topic', 'list', '--help', **built.variables()).err == ''
    assert list(sourced_workspaces.faults(built.variables())) == []


UNREADABLE = Path('/proc/self/mem')
"""A file that no user can read from its beginning, not even root."""


@pytest.mark.starts
def test_an_unreadable_library_is_reported(built):
    library = built.prefix / f'lib/lib{NAME}__rosidl_typesupport_c.so'
    library.unlink()
    library.symlink_to(UNREADABLE)
    assert error_of_import(built).startswith('cannot be read ([Errno 5] Input/output error), so')


@pytest.mark.starts
def test_a_list_of_definitions_that_is_not_valid_utf_8_is_reported(built):
    (built.prefix / overlays.INDEX / NAME).write_bytes(b'srv/\xff.srv')
    assert error_of_import(built).startswith(
        "cannot be read ('utf-8' codec can't decode byte 0xff in position 4"
    )


def test_an_unreadable_package_folder_raises_an_import_error(built, monkeypatch):
    def refuse(path):
        raise PermissionError(13, 'Permission denied', path)

    monkeypatch.setattr(sourced.os, 'listdir', refuse)
    with pytest.raises(ImportError, match=r'cannot be read \(\[Errno 13\] Permission denied: '):
        sourced._check_package(str(built.modules.parent), NAME)


@pytest.mark.starts
@pytest.mark.parametrize('text', ['{', '[]', '{}', '{"type_hashes": [3]}', '{"type_hashes": 3}'])
def test_a_broken_type_description_is_reported(built, text):
    file = f'share/{NAME}/srv/SolveIK.json'
    (built.prefix / file).write_text(text)
    assert warning_of_import(built) == f'has a broken {file}{built.again()}'


@pytest.mark.starts
def test_an_unreadable_source_is_reported(built):
    source = built.workspace / f'src/{NAME}/srv/SolveIK.srv'
    source.unlink()
    source.symlink_to(UNREADABLE)
    assert warning_of_import(built) == (
        f'cannot be compared with its sources ([Errno 5] Input/output error){built.again()}'
    )


@pytest.mark.starts
def test_an_unreadable_definition_is_reported_and_the_import_succeeds(built):
    (built.prefix / DEFINITION).unlink()
    (built.prefix / DEFINITION).mkdir()
    imported = built.python(f'import {NAME}.srv')
    assert imported.returncode == 0
    assert 'cannot be compared with its sources ([Errno 21] Is a directory' in imported.stderr


@pytest.mark.starts
def test_faults_are_reported_also_if_an_old_copy_of_the_course_is_found_first(built, tmp_path):
    old = tmp_path / f'old/install/my_robot_basics/lib/{PYTHON}/site-packages/my_robot_basics'
    old.mkdir(parents=True)
    (old / '__init__.py').touch()
    folders = f'{old.parent}:{built.variables()["PYTHONPATH"]}'
    terminal = {'PYTHONPATH': folders, 'COURSE_LANGUAGE': 'zh_CN'}  # which only a newer copy has
    source = built.workspace / f'src/{NAME}/srv/SolveIK.srv'
    source.write_text('float64 x\n---\n')
    changed = built.python(
        f'import {NAME}.srv, my_robot_basics as m; print(m.__file__)', **terminal
    )
    assert changed.stdout.strip() == str(old / '__init__.py')
    assert 'was built before srv/SolveIK.srv in src was changed' in changed.stderr
    (built.prefix / DEFINITION).unlink()
    broken = built.python(f'import {NAME}.srv', **terminal)
    assert f'ImportError: {NAME} in {built.prefix} is only half built' in broken.stderr


ASKER = f"""
import rclpy
from {NAME}.srv import SolveIK
rclpy.init()
node = rclpy.create_node('asker')
publisher = node.create_publisher(SolveIK.Request, '/requests', 1)
print('there', flush=True)
rclpy.spin(node)
"""


@pytest.mark.starts
def test_the_topic_doctor_ends_with_the_error_about_a_half_built_package(built):
    (built.prefix / f'lib/lib{NAME}__rosidl_generator_c.so').unlink()
    with own_domain(), started(sys.executable, '-P', '-c', ASKER) as asker:
        assert asker.stdout.readline() == 'there\n'
        doctor = subprocess.run(
            [SCRIPT.with_name('topic_doctor'), '/requests'],
            env=built.variables() | {'ROS_DOMAIN_ID': os.environ['ROS_DOMAIN_ID']},
            capture_output=True,
            text=True,
            timeout=PATIENCE_SEC,
        )
    sentence, last = doctor.stderr.splitlines()
    assert (doctor.returncode, doctor.stdout) == (2, '')
    assert 'is only half built' in sentence
    assert last == f'{NAME}/srv/SolveIK_Request cannot be loaded, for the reason above'
