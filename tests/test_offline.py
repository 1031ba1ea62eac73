"""A machine without a network: `./course wheels` fills a folder, `--offline` installs from it."""

import functools
import hashlib
import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fresh_machine import fresh_clone, fresh_environment
from my_robot_basics.session import build_tools

from grader.authoring.bundle import FOLDER, bundle
from grader.course import ROOT, Course
from launcher.environment import Environment
from launcher.installer import NETWORK_IS_AWAY, Installer
from launcher.messages import LauncherError
from launcher.offline import CONTENTS, PYTHONS, check_wheels, read_pins
from launcher.wheels import pythons, read_earlier_download

PINS = """\
# a comment
ada==1.0 \\
    --hash=sha256:{ada}
bob==2.0 \\
    --hash=sha256:{other} \\
    --hash=sha256:{bob}
"""
DIGESTS = {name: hashlib.sha256(name.encode()).hexdigest() for name in ('ada', 'bob', 'other')}
FILES = {'ada-1.0-py3-none-any.whl': 'ada', 'bob-2.0.tar.gz': 'bob'}
HERE = f'{sys.version_info[0]}.{sys.version_info[1]}'
NO_NETWORK = ('bwrap', '--dev-bind', '/', '/', '--unshare-net', '--die-with-parent')
BUILD = (
    'cd "$ROS_WS" && colcon build --packages-select {} && source install/setup.bash && '
    'ros2 pkg prefix {}'
)


@pytest.fixture
def folder(tmp_path):
    """A folder of wheels that was downloaded for Python 3.12."""
    folder = tmp_path / 'wheels'
    folder.mkdir()
    for name in FILES:
        (folder / name).touch()
    files = {name: DIGESTS[content] for name, content in FILES.items()}
    (folder / CONTENTS).write_text(json.dumps({'3.12': files}))
    return folder


@pytest.fixture
def pins(tmp_path):
    path = tmp_path / 'environment.txt'
    path.write_text(PINS.format(**DIGESTS))
    return path


def refusal(*arguments):
    with pytest.raises(LauncherError) as caught:
        check_wheels(*arguments)
    return str(caught.value)


def test_one_file_of_each_pin_is_enough(folder, pins):
    check_wheels(folder, '3.12.1', pins)


def test_a_folder_for_another_python_is_refused(folder, pins):
    said = refusal(folder, '3.13.0', pins)
    assert 'is for Python 3.12, and this one is 3.13.0' in said
    assert './course wheels --python 3.13' in said


def test_a_file_that_was_not_copied_is_named(folder, pins):
    (folder / 'bob-2.0.tar.gz').unlink()
    assert f'{folder} lacks bob==2.0 for Python 3.12' in refusal(folder, '3.12.1', pins)


def test_a_folder_of_another_version_of_the_course_is_refused(folder, pins):
    pins.write_text(pins.read_text().replace(DIGESTS['ada'], DIGESTS['other']))
    said = refusal(folder, '3.12.1', pins)
    assert 'lacks ada==1.0 for Python 3.12' in said
    assert 'another version of the course' in said


@pytest.mark.parametrize('above', ['a file', '/proc'])
def test_a_folder_that_cannot_be_made_is_refused(above, tmp_path):
    folder = Path('/proc/wheels')
    if above == 'a file':
        folder = tmp_path / 'README.md'
        folder.write_text('kept')
    with pytest.raises(LauncherError) as refused:
        read_earlier_download(folder)
    assert str(refused.value).startswith(f'{folder} cannot be made (')
    assert str(refused.value).endswith('): name another folder, a new or an empty one.')


@pytest.mark.parametrize('content', [None, '{'])
def test_a_folder_that_course_wheels_did_not_finish_is_refused(content, tmp_path, pins):
    if content:
        (tmp_path / CONTENTS).write_text(content)
    assert 'which ./course wheels writes last' in refusal(tmp_path, '3.12.1', pins)


def test_a_folder_with_other_files_is_refused(tmp_path):
    (tmp_path / 'thesis.odt').touch()
    with pytest.raises(LauncherError, match='is not empty and was not made by'):
        read_earlier_download(tmp_path)


def test_the_python_versions_are_those_of_the_pins():
    assert f'for CPython {PYTHONS[0]} to {PYTHONS[-1]}' in (ROOT / 'environment.txt').read_text()
    assert pythons('3.12,3.11,3.12') == ['3.12', '3.11']
    with pytest.raises(Exception, match=r"'3.10' is not among 3\.11, 3\.12, 3\.13"):
        pythons('3.10')


def test_each_pin_has_its_hashes():
    text = (ROOT / 'environment.txt').read_text()
    found = read_pins(ROOT / 'environment.txt')
    assert len(found) == text.count('==')
    assert sum(map(len, found.values())) == text.count('--hash=sha256:')


@pytest.mark.parametrize('uv', [True, False])
def test_an_offline_installation_uses_only_the_folder_of_wheels(uv, monkeypatch, tmp_path):
    commands = []
    monkeypatch.setattr(Installer, 'run', lambda self, *command, **_: commands.append(command))
    installer = Installer(Environment(tmp_path), {'PATH': ''}, 0, Path('/wheels'))
    object.__setattr__(installer, 'uses_uv', uv)
    installer.install('-r', 'environment.txt')
    (command,) = (' '.join(map(str, each)) for each in commands)
    assert '--no-index --find-links /wheels -r environment.txt' in command
    assert ('--offline --no-config' if uv else '--isolated') in command


def test_a_missing_folder_of_wheels_is_reported_in_one_sentence():
    run = subprocess.run(
        [ROOT / 'course', '--offline', '/nowhere', 'lab'], capture_output=True, text=True
    )
    assert run.returncode == 1
    assert run.stderr == (
        "course: --offline needs a folder that ./course wheels made, and '/nowhere' is not one.\n"
    )


# --- in a network namespace where there is no network --------------------------------------------


@pytest.fixture(scope='module')
def wheels(tmp_path_factory):
    """All that this Python needs, downloaded once."""
    folder = tmp_path_factory.mktemp('offline') / 'wheels'
    subprocess.run([ROOT / 'course', 'wheels', '--python', HERE, folder], check=True)
    return folder


def apart(course, environment, *command):
    """Run a command of a course without a network."""
    return subprocess.run(
        [*NO_NETWORK, './course', *map(str, command)],
        cwd=course,
        env=environment,
        capture_output=True,
        text=True,
    )


@pytest.mark.slow
@pytest.mark.isolation
@pytest.mark.timeout(1800)
@pytest.mark.parametrize('installer', ['pip', 'uv'])
def test_the_bundle_is_set_up_and_builds_its_workspace_without_a_network(
    installer, wheels, tmp_path
):
    environment = fresh_environment(tmp_path)
    assert bool(shutil.which('uv', path=environment['PATH'])) is False
    if installer == 'uv':
        (tmp_path / 'tools/uv').symlink_to(Path(sys.prefix, 'bin/uv'))
    bundle(Course(), tmp_path / 'students.zip')
    with zipfile.ZipFile(tmp_path / 'students.zip') as box:
        box.extractall(tmp_path)
    students = tmp_path / FOLDER
    (students / 'course').chmod(0o755)
    refused = apart(students, environment | {'PIP_RETRIES': '1'}, 'workspace')
    assert refused.returncode == 1
    assert refused.stderr.endswith(f'course: {NETWORK_IS_AWAY}\n')  # so there is no network

    made = apart(students, environment, '--offline', wheels, 'workspace')
    assert made.returncode == 0, made.stderr
    package = 'my_robot_basics'
    built = apart(students, environment, 'ros-shell', '-c', BUILD.format(package, package))
    assert built.returncode == 0, built.stderr
    assert built.stdout.splitlines()[-1].endswith(f'ros_ws/install/{package}')


@pytest.fixture(scope='module')
def offline(wheels, tmp_path_factory):
    """Run a command of the whole course, set up without a network."""
    folder = tmp_path_factory.mktemp('whole')
    clone, environment = fresh_clone(folder / 'clone'), fresh_environment(folder)
    (folder / 'tools/uv').symlink_to(Path(sys.prefix, 'bin/uv'))
    environment['PATH'] += ':/usr/bin'  # a compiler comes from the system
    environment['COURSE_WHEELS'] = str(wheels)
    return functools.partial(apart, clone, environment)


@pytest.mark.slow
@pytest.mark.isolation
@pytest.mark.timeout(1800)
def test_the_whole_course_is_set_up_and_validates_without_a_network(offline):
    validated = offline('validate', ROOT / 'solutions/02_joint_state/02_joint_state.ipynb')
    assert validated.returncode == 0, validated.stdout + validated.stderr


@pytest.mark.slow
@pytest.mark.isolation
@pytest.mark.timeout(1800)
@pytest.mark.skipif(
    bool(build_tools.missing_programs()), reason='there is no compiler, or no CMake'
)
def test_the_whole_course_builds_its_interfaces_without_a_network(offline):
    assert offline('workspace').returncode == 0
    built = offline('ros-shell', '-c', BUILD.format(*['arm_interfaces'] * 2))
    assert built.returncode == 0, built.stderr
    assert built.stdout.splitlines()[-1].endswith('ros_ws/install/arm_interfaces')
