import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from ament_index_python import get_package_prefix, get_package_share_directory
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / 'my_robot_basics'
UV = Path(sys.prefix, 'bin/uv')
INTERFACES = 'arm_interfaces/wheel/*.whl'
PYTHONS = ['3.11', '3.12', '3.13']
THIS = '{}.{}'.format(*sys.version_info)

TEXT = (ROOT / 'environment.txt').read_text()
LINES = re.sub(r' \\\n +--hash=sha256:[0-9a-f]{64}', '', TEXT).splitlines()
PROJECT = tomllib.loads((ROOT / 'pyproject.toml').read_text())['project']

# what the wheels of ROS set for this Python must not reach another one's libraries
ENVIRONMENT = {
    name: value
    for name, value in os.environ.items()
    if name not in ('LD_LIBRARY_PATH', '_ROS_WHEELS_BOOTSTRAP_COMPLETE', 'VIRTUAL_ENV')
}


def run(*command):
    return subprocess.run(
        [str(part) for part in command], cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True
    )


def pins_of(lines):
    requirements = [Requirement(line) for line in lines if line and not line.startswith('#')]
    return {canonicalize_name(r.name): str(r.specifier) for r in requirements}


PINS = pins_of(LINES)


def test_every_line_is_one_exact_pin():
    pins = [line for line in LINES if not line.startswith('#')]
    assert [line for line in pins if not re.fullmatch(r'[a-z0-9-]+==[0-9][\w.+]*', line)] == []
    assert len(PINS) == len(pins)


def test_every_pin_has_hashes_of_its_files():
    blocks = re.split(r'^(?=\w)', TEXT, flags=re.MULTILINE)[1:]
    assert len(blocks) == len(PINS)
    assert [
        block for block in blocks if not re.search(r'--hash=sha256:[0-9a-f]{64}$', block, re.M)
    ] == []


def test_students_need_no_tools_of_the_developers():
    students, _, course = TEXT.partition('\n# --- what only the whole course needs')
    tools = [Requirement(text).name for text in PROJECT['optional-dependencies']['test']]
    needed = pins_of(re.findall(r'^\S+==\S+', students, re.MULTILINE))
    # colcon asks for pytest and its coverage itself
    assert {name for name in tools if name in needed} == {'pytest', 'pytest-cov'}
    assert {'playwright', 'ruff', 'mypy', 'hypothesis', 'nbval'} <= pins_of(
        re.findall(r'^\S+==\S+', course, re.MULTILINE)
    ).keys()
    assert {'jupyterlab', 'ros-jazzy-rclpy', 'colcon-core'} <= needed.keys()


def test_the_header_of_environment_txt_names_the_command_that_makes_the_file():
    header = ' '.join(line for line in LINES if line.startswith('#'))
    assert 'uv pip compile' in header
    assert '.ci/pin.py' in header
    assert not re.search(r'https?:|file:|--index|find-links', TEXT)


def test_every_direct_requirement_is_pinned_and_in_its_range():
    extras = [text for extra in PROJECT['optional-dependencies'].values() for text in extra]
    requirements = [Requirement(text) for text in [*PROJECT['dependencies'], *extras]]
    requirements += [Requirement(text) for text in metadata.requires('my_robot_basics') or []]
    requirements = [r for r in requirements if not r.marker or r.marker.evaluate({'extra': ''})]
    missing = [r.name for r in requirements if canonicalize_name(r.name) not in PINS]
    assert missing == []
    wrong = [r for r in requirements if PINS[canonicalize_name(r.name)][2:] not in r.specifier]
    assert wrong == []


def test_the_installed_packages_are_exactly_the_pinned_ones():
    ours = {'my-robot-basics', 'my-robot-basics-grader', 'arm-interfaces'}
    installed = {
        canonicalize_name(d.name): f'=={d.version}'
        for d in metadata.distributions(path=[sysconfig.get_path('purelib')])
    }
    # Python modules that the ROS wheels bring along under the names of their ROS packages
    extra = {name: pin for name, pin in installed.items() if f'ros-{name}' in PINS}
    others = {n: pin for n, pin in installed.items() if n not in ours and n not in extra}
    assert others.items() - PINS.items() == set()
    assert PINS.items() - installed.items() == set()


def test_the_ament_index_knows_our_package_here(monkeypatch):
    monkeypatch.setenv('AMENT_PREFIX_PATH', sys.prefix)
    assert get_package_prefix('my_robot_basics') == sys.prefix
    share = Path(get_package_share_directory('my_robot_basics'))
    assert (share / 'package.xml').read_bytes() == (PACKAGE / 'package.xml').read_bytes()
    points = metadata.distribution('my_robot_basics').entry_points
    # where `ros2 run` looks
    executables = {path.name: path for path in Path(sys.prefix, 'lib/my_robot_basics').iterdir()}
    assert set(executables) == {point.name for point in points.select(group='console_scripts')}
    assert all(os.access(path, os.X_OK) for path in executables.values())


@pytest.mark.starts
@pytest.mark.parametrize('version', PYTHONS)
def test_a_resolver_adds_nothing_to_the_pins_and_finds_a_wheel_of_each(version):
    resolved = run(
        *(UV, 'pip', 'compile', '--quiet', '--no-annotate', '--no-header'),
        *('--python-version', version, '--python-platform', 'x86_64-manylinux_2_28'),
        *('--only-binary', ':all:', '--no-binary', 'empy'),  # plain Python, and has no wheel
        *('--all-extras', '--constraints', 'environment.txt', 'pyproject.toml'),
    )
    assert resolved.returncode == 0, resolved.stderr
    assert pins_of(resolved.stdout.splitlines()).items() - PINS.items() == set()


def interpreters():
    """The Pythons of this machine, those of pyenv too: minor version -> path."""
    pyenv = Path(os.environ.get('PYENV_ROOT', Path.home() / '.pyenv'))
    on_path = [shutil.which(f'python{version}') for version in PYTHONS]
    candidates = [sys._base_executable, *on_path, *sorted(pyenv.glob('versions/*/bin/python'))]
    found = {}
    for python in filter(None, candidates):
        probe = run(python, '-c', 'import sys; print("%d.%d" % sys.version_info[:2])')
        if probe.returncode == 0:
            found.setdefault(probe.stdout.strip(), python)
    return found


@pytest.fixture(scope='module')
def found():
    return interpreters()


@pytest.fixture
def venv(tmp_path):
    yield tmp_path / 'venv'
    shutil.rmtree(tmp_path / 'venv', ignore_errors=True)  # it is 0.9 GB


@pytest.mark.starts
def test_the_running_python_is_a_supported_one(found):
    assert THIS in found.keys() & set(PYTHONS)


@pytest.mark.slow  # a session runs in what was installed; for the others, the resolver has to do
@pytest.mark.parametrize('version', PYTHONS)
def test_the_pins_install_on_each_python_of_this_machine(version, found, venv):
    if version not in found:
        pytest.skip(f'this machine has no Python {version} to install on')
    python = venv / 'bin/python'
    use_the_main_parts = (
        'import matplotlib.pyplot, nbgrader, numpy, rclpy, sensor_msgs.msg, jupyterlab, nbval\n'
        'rclpy.init(); rclpy.create_node("_probe"); rclpy.shutdown()'
    )
    for command in (
        [UV, 'venv', '--python', found[version], venv],
        # without dependencies: what the pins forget is then missing
        [UV, 'pip', 'install', '--python', python, '--no-deps', '-r', 'environment.txt'],
        [UV, 'pip', 'install', '--python', python, '--no-deps', *ROOT.glob(INTERFACES)],
        [UV, 'pip', 'check', '--python', python],
        [python, '-c', use_the_main_parts],
        [python, '-P', 'tests/round_trip.py'],
    ):
        step = run(*command)
        assert step.returncode == 0, step.stdout + step.stderr
