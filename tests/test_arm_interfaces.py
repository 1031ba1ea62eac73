"""The package arm_interfaces, and its wheel: made of the same sources, and usable on any Linux."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path
from xml.etree import ElementTree

import pytest
from ros2_command import own_domain, ros2

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / 'arm_interfaces'
RECIPE = PACKAGE / 'wheel/build_wheel.py'
(WHEEL,) = PACKAGE.glob('wheel/*.whl')
VERSION = ElementTree.parse(PACKAGE / 'package.xml').findtext('version')
INTERFACES = ['action/MoveArm.action', 'srv/SolveIK.srv']
SHARE = f'arm_interfaces-{VERSION}.data/data/share/arm_interfaces'
REBUILD = f'the wheel is older than its sources: run {RECIPE.relative_to(ROOT)}'
MANYLINUX = {'GLIBC': (2, 28), 'GLIBCXX': (3, 4, 25), 'CXXABI': (1, 3, 11), 'GCC': (7,)}
"""The latest symbols of the systems that the wheel is for."""


def contents(wheel):
    with zipfile.ZipFile(wheel) as box:
        return {name: box.read(name) for name in box.namelist()}


@pytest.fixture(scope='module')
def wheel():
    """What is in the wheel: path to bytes."""
    return contents(WHEEL)


# --- the wheel and its sources -------------------------------------------------------------------


def test_the_wheel_is_up_to_date_with_its_sources(wheel):
    listed = subprocess.run(
        ['git', 'ls-files', '--cached', '--others', '--exclude-standard', '.'],
        cwd=PACKAGE,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    # CMake makes the package without a wheel
    sources = set(listed) - {'CMakeLists.txt', f'wheel/{WHEEL.name}'}
    digests = {name: hashlib.sha256((PACKAGE / name).read_bytes()).hexdigest() for name in sources}
    written = wheel[f'{SHARE}/wheel_sources.sha256'].decode()
    assert written == ''.join(f'{digests[name]}  {name}\n' for name in sorted(digests)), REBUILD


def test_the_wheel_contains_the_interface_definitions_unchanged(wheel):
    for name in (*INTERFACES, 'package.xml'):
        assert wheel[f'{SHARE}/{name}'] == (PACKAGE / name).read_bytes(), REBUILD


def test_cmake_makes_the_same_interfaces():
    made = (PACKAGE / 'CMakeLists.txt').read_text()
    assert sorted(re.findall(r'"(\w+/\w+\.\w+)"', made)) == INTERFACES
    found = [*PACKAGE.glob('*/*.srv'), *PACKAGE.glob('*/*.action'), *PACKAGE.glob('*/*.msg')]
    assert sorted(str(path.relative_to(PACKAGE)) for path in found) == INTERFACES


def test_the_wheels_name_states_python_abi_and_platform(wheel):
    assert WHEEL.name == f'arm_interfaces-{VERSION}-cp311-abi3-manylinux_2_28_x86_64.whl'
    modules = [name for name in wheel if name.startswith('arm_interfaces/') and '.so' in name]
    assert modules == ['arm_interfaces/arm_interfaces_s__rosidl_typesupport_c.abi3.so']


def test_the_wheel_was_built_against_the_pinned_packages(wheel):
    text = wheel[f'arm_interfaces-{VERSION}.dist-info/METADATA'].decode()
    required = re.findall(r'^Requires-Dist: (.*)$', text, re.MULTILINE)
    pinned = set(re.findall(r'^\S+==\S+', (ROOT / 'environment.txt').read_text(), re.MULTILINE))
    assert len(required) == 12
    assert set(required) - pinned == set(), REBUILD


def test_the_installed_files_are_those_of_the_wheel(wheel):
    installed = metadata.distribution('arm_interfaces')
    for name, content in wheel.items():
        if '.dist-info/' in name:
            continue
        below_data = name.partition('.data/data/')[2]
        path = Path(sys.prefix, below_data) if below_data else installed.locate_file(name)
        assert Path(path).read_bytes() == content, f'{path}: run ./course doctor'


def symbols(library, *options):
    """Names of a library's dynamic symbols, and their versions."""
    run = subprocess.run(['nm', '-D', *options, library], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return {line.split()[-1] for line in run.stdout.splitlines()}


def libraries(folder):
    return sorted(folder.rglob('*.so'))


@pytest.fixture(scope='module')
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp('wheel')
    with zipfile.ZipFile(WHEEL) as box:
        box.extractall(folder)
    return folder


@pytest.mark.starts
@pytest.mark.skipif(not shutil.which('nm'), reason='this machine has no nm')
def test_the_wheels_libraries_need_no_newer_symbols_than_manylinux_2_28(unpacked):
    assert len(libraries(unpacked)) == 5
    for library in libraries(unpacked):
        for symbol in symbols(library, '--undefined-only'):
            if found := re.fullmatch(r'.*@+(\w+)_([\d.]+)', symbol):
                version = tuple(map(int, found[2].split('.')))
                assert version <= MANYLINUX[found[1]], f'{library.name}: {symbol}'


@pytest.mark.slow
@pytest.mark.skipif(not (shutil.which('gcc') and shutil.which('nm')), reason='there is no gcc')
def test_the_recipe_reproduces_the_wheel(wheel, unpacked, tmp_path):
    environment = os.environ | {'AMENT_PREFIX_PATH': sys.prefix}
    subprocess.run([sys.executable, RECIPE, tmp_path], env=environment, check=True)
    (made,) = tmp_path.glob('*.whl')
    assert made.name == WHEEL.name
    again = contents(made)
    assert again.keys() == wheel.keys()
    for name, content in again.items():
        # another compiler makes other machine code, and RECORD has its digest; type hashes are
        # in the .json files
        if not name.endswith(('.so', '/RECORD')):
            assert content == wheel[name], f'{name} has changed: {REBUILD}'
    with zipfile.ZipFile(made) as box:
        box.extractall(tmp_path / 'again')
    for one, other in zip(libraries(tmp_path / 'again'), libraries(unpacked), strict=True):
        assert one.name == other.name
        assert ours(symbols(one)) == ours(symbols(other)), one.name


def ours(names):
    """Symbols of ROS and Python: those of the C library differ from compiler to compiler."""
    return {name for name in names if '@' not in name and not name.startswith(('__', '_Z'))}


# --- the interfaces in use -----------------------------------------------------------------------


@pytest.mark.starts
def test_each_interface_type_survives_a_round_trip():
    program = Path(__file__).with_name('round_trip.py')
    with own_domain():
        run = subprocess.run(
            [sys.executable, '-P', program],
            capture_output=True,
            text=True,
            timeout=120,
        )
    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stderr == ''
    assert run.stdout.split()[-2:] == ['SolveIK', 'MoveArm']
    assert len(run.stdout.split()) == 15


@pytest.mark.starts
def test_ros2_lists_and_shows_the_interfaces():
    shown = ros2('interface', 'show', 'arm_interfaces/srv/SolveIK')
    assert (shown.status, shown.err) == (0, '')
    assert 'geometry_msgs/Point target' in shown.out
    assert (
        'bool reachable\n'
        in ros2('interface', 'show', 'arm_interfaces/srv/SolveIK', '--no-comments').out
    )
    assert 'float64 speed' in ros2('interface', 'show', 'arm_interfaces/action/MoveArm').out
    everything = ros2('interface', 'list').out
    assert '    arm_interfaces/srv/SolveIK\n' in everything
    assert '    arm_interfaces/action/MoveArm\n' in everything
    assert 'arm_interfaces\n' in ros2('pkg', 'list').out
