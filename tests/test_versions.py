"""The hash of the code and the packages that a result was made with."""

import os
import shutil
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from grader.common import versions
from grader.course import ROOT
from grader.sandbox import limits


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A machine whose code and packages can be changed; says what its hash is now."""
    grader, robot = tmp_path / 'grader', tmp_path / 'my_robot_basics'
    for folder in (grader / 'forkserver', robot / 'checks'):
        folder.mkdir(parents=True)
        (folder / 'code.py').write_text('1')
    shutil.copy(limits.__file__, grader)
    packages = tmp_path / 'site-packages'
    for name in ('numpy-2.3.0.dist-info', 'rclpy-7.1.5-py3.11.egg-info', 'numpy'):
        (packages / name).mkdir(parents=True)
    monkeypatch.setattr(versions, '__file__', str(grader / 'common' / 'versions.py'))
    monkeypatch.setattr(versions.my_robot_basics, '__file__', str(robot / '__init__.py'))
    monkeypatch.setattr(versions.sysconfig, 'get_path', {'purelib': str(packages)}.get)

    def now():
        versions.software_hash.cache_clear()
        return versions.software_hash()

    yield SimpleNamespace(
        grader=grader, robot=robot, packages=packages, now=now, patch=monkeypatch
    )
    versions.software_hash.cache_clear()


def grader_code(machine):
    (machine.grader / 'forkserver' / 'code.py').write_text('2')


def a_new_module_of_the_grader(machine):
    (machine.grader / 'new.py').touch()


def a_limit(machine):
    table = machine.grader / 'limits.py'
    text = table.read_text()
    table.write_text(text.replace('TIMEOUT_SEC = 1_800.0', 'TIMEOUT_SEC = 900.0', 1))
    assert table.read_text() != text


def code_of_the_robot(machine):
    (machine.robot / 'checks' / 'code.py').write_text('2')


def another_name_of_a_module(machine):
    code = machine.robot / 'checks' / 'code.py'
    code.rename(code.with_name('other.py'))


def another_version(machine):
    numpy = machine.packages / 'numpy-2.3.0.dist-info'
    numpy.rename(numpy.with_name('numpy-2.3.1.dist-info'))


def one_package_more(machine):
    (machine.packages / 'new-1.dist-info').mkdir()


def one_package_less(machine):
    (machine.packages / 'rclpy-7.1.5-py3.11.egg-info').rmdir()


def another_python(machine):
    machine.patch.setattr(versions.platform, 'python_version', lambda: '3.99')


def another_processor(machine):
    machine.patch.setattr(versions.platform, 'machine', lambda: 'pdp11')


@pytest.mark.parametrize(
    'change',
    [
        grader_code,
        a_new_module_of_the_grader,
        a_limit,
        code_of_the_robot,
        another_name_of_a_module,
        another_version,
        one_package_more,
        one_package_less,
        another_python,
        another_processor,
    ],
)
def test_the_hash_changes_with_code_limits_packages_python_and_processor(machine, change):
    before = machine.now()
    assert machine.now() == before
    change(machine)
    assert machine.now() != before


def test_bytecode_and_symbolic_links_do_not_change_the_hash(machine):
    before = machine.now()
    (machine.robot / '__pycache__').mkdir()
    (machine.robot / '__pycache__' / 'code.pyc').write_text('1')
    (machine.robot / '.#code.py').symlink_to('who@a-machine.1')  # Emacs locks what it edits
    (machine.robot / 'itself').symlink_to(machine.robot)
    assert machine.now() == before


def test_the_order_of_folder_entries_does_not_change_the_hash(machine, monkeypatch):
    before, scandir = machine.now(), os.scandir
    monkeypatch.setattr(
        versions.os, 'scandir', lambda folder: nullcontext([*scandir(folder)][::-1])
    )
    assert machine.now() == before


def test_the_hash_covers_the_grader_and_the_package_of_this_clone():
    folders = {Path(versions.__file__).parents[1], Path(versions.my_robot_basics.__file__).parent}
    assert folders == {ROOT / 'grader', ROOT / 'my_robot_basics' / 'my_robot_basics'}
    assert limits.__file__ in versions._code(str(ROOT / 'grader'))
