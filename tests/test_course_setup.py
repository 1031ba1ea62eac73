"""What `./course` sets up and when, with which Python, and what it says if it cannot."""

import os
import re
import shlex
import shutil
import subprocess
import sys

import pytest
from course_machine import PYTHON, ROOT, UV, Machine, the_one_sentence, with_programs

IN_A_NAMESPACE = [
    shutil.which('unshare'),
    '--mount',
    *([] if os.geteuid() == 0 else ['--map-root-user']),
]


@pytest.fixture
def bare(tmp_path):
    """A machine with neither Python nor uv."""
    return Machine(tmp_path)


@pytest.fixture
def machine(bare):
    """A machine with a Python and a uv that only record their arguments."""
    return with_programs(bare)


# --- when it sets up -----------------------------------------------------------------------------
def test_the_first_call_sets_up_the_environment_and_the_second_does_not(machine):
    first = machine.course('scores')
    assert first.returncode == 0, first.stderr
    assert len(machine.calls('uv venv')) == 1
    assert len(machine.calls('uv pip install')) == 3  # build tools, pins, our own
    second = machine.course('scores')
    assert (second.returncode, second.stderr) == (0, '')
    assert not machine.calls('uv')
    assert machine.calls('python -P')


def test_pip_sets_up_the_environment_if_uv_is_missing(machine):
    (machine.programs / 'uv').unlink()
    assert machine.course('scores').returncode == 0
    assert len(machine.calls('python -m venv')) == 1
    assert len(machine.calls('python -m pip install')) == 3
    assert machine.course('scores').stderr == ''


def test_a_uv_that_does_not_run_is_not_used(machine):
    machine.program('uv', 'echo "pyenv: uv: command not found" >&2; exit 127')
    assert machine.course('scores').returncode == 0
    assert len(machine.calls('python -m venv')) == 1


def other_pins(machine):
    with (machine.root / 'environment.txt').open('a') as file:
        file.write('six==1.17.0\n')


def half_made(machine):
    (machine.root / '.venv/made_environment').unlink()


def marker_cut_short(machine):
    (machine.root / '.venv/made_environment').write_text(f'{machine.root}\n3.12.1\n')


def python_gone(machine):
    python = machine.root / '.venv/bin/python'
    python.unlink()
    python.symlink_to('/nowhere/python3')


def python_upgraded(machine):
    python = machine.root / '.venv/bin/python'
    python.write_text(python.read_text().replace('3.12.1', '3.13.0'))


def moved(machine):
    machine.root = machine.root.rename(machine.root.with_name('moved course'))


@pytest.mark.parametrize(
    'happening', [other_pins, half_made, marker_cut_short, python_gone, python_upgraded, moved]
)
def test_the_environment_is_made_again_after_a_change(happening, machine):
    machine.course('scores')
    leftover = machine.root / '.venv/leftover'
    leftover.touch()
    happening(machine)
    run = machine.course('scores')
    assert run.returncode == 0, run.stderr
    assert len(machine.calls('uv venv')) == 1
    assert not (machine.root / '.venv/leftover').exists()
    assert machine.course('scores').stderr == ''


def test_a_different_python_named_by_the_user_is_set_up(machine):
    machine.course('scores')
    machine.program('other', re.sub(r"(echo '?)3\.12\.1", r'\g<1>3.13.0', PYTHON))
    run = machine.course('scores', PYTHON='other')
    assert 'with Python 3.13.0' in run.stderr


def test_new_entry_points_are_installed_without_a_new_environment(machine):
    machine.course('scores')
    with (machine.root / 'my_robot_basics/setup.py').open('a') as file:
        file.write('# another console script\n')
    assert machine.course('scores').returncode == 0
    assert not machine.calls('uv venv')
    assert [
        call for call in machine.calls('uv pip install') if '-e ./my_robot_basics -e .' in call
    ]
    assert machine.course('scores').stderr == ''


def test_a_changed_wheel_of_the_same_version_is_installed(machine):
    machine.course('scores')
    machine.calls('uv')
    (wheel,) = machine.root.glob('arm_interfaces/wheel/*.whl')
    with wheel.open('ab') as file:
        file.write(b'changed')
    assert machine.course('scores').returncode == 0
    assert [call for call in machine.calls('uv pip install') if call.endswith(f'/{wheel.name}')]
    assert machine.course('scores').stderr == ''


def test_a_missing_wheel_of_the_interfaces_is_reported(machine):
    (wheel,) = machine.root.glob('arm_interfaces/wheel/*.whl')
    wheel.unlink()
    sentence = the_one_sentence(machine.course('scores'))
    assert sentence.startswith('arm_interfaces/wheel/ has 0 wheels (*.whl), expected one: ')


def test_ros_finds_the_package_and_its_executables(machine):
    setup = machine.root / 'my_robot_basics/setup.py'
    first = "'hello_node = my_robot_basics.hello_node:main',"
    for name in ['extra_node', 'other_node']:
        text = (ROOT / 'my_robot_basics/setup.py').read_text()
        setup.write_text(
            text.replace(first, f"{first}\n            '{name} = my_robot_basics.{name}:main',")
        )
        assert machine.course('scores').returncode == 0
        venv = machine.root / '.venv'
        assert (venv / 'share/ament_index/resource_index/packages/my_robot_basics').is_file()
        description = (venv / 'share/my_robot_basics/package.xml').read_text()
        assert description == (setup.parent / 'package.xml').read_text()
        links = {path.name: os.readlink(path) for path in (venv / 'lib/my_robot_basics').iterdir()}
        # an executable that is gone from setup.py is gone here, too
        assert {name, 'hello_node', 'kinematics_publisher'} <= links.keys()
        assert {'extra_node', 'other_node'} & links.keys() == {name}
        assert links == {name: f'../../bin/{name}' for name in links}


def test_an_environment_that_failed_is_never_used(machine):
    machine.program('uv', UV + 'case $* in *environment.txt*) echo broken; exit 1 ;; esac')
    for _ in range(2):
        assert machine.course('scores').returncode == 1
        assert machine.calls('uv venv')
        assert not machine.calls('python -P')
    machine.program('uv', UV)
    assert machine.course('scores').returncode == 0
    assert machine.calls('uv venv')


def test_two_calls_at_once_set_up_once(machine):
    machine.program('uv', UV + 'case $1 in venv) sleep 2 ;; esac')
    script = shlex.quote(str(machine.root / 'course'))
    twice = f'{script} scores & {script} scores; first=$?; wait $! && exit $first'
    run = machine.course('-c', twice, script=shutil.which('sh'))
    assert run.returncode == 0, run.stderr
    assert len(machine.calls('uv venv')) == 1
    assert len(machine.calls('python -P -m grader scores')) == 2
    assert 'waiting for another ./course' in run.stderr


# --- machines on which it can't work -------------------------------------------------------------
@pytest.mark.parametrize(
    ('system', 'processor'),
    [('Darwin', 'arm64'), ('Linux', 'aarch64'), ('MINGW64_NT-10.0', 'x86_64')],
)
def test_an_unsupported_machine_is_reported(bare, system, processor):
    bare.program('uname', f'case $1 in -s) echo {system} ;; *) echo {processor} ;; esac')
    sentence = the_one_sentence(bare.course('lab'))
    assert f'{system} on {processor}' in sentence
    assert 'use such a machine' in sentence


def test_a_missing_python_is_reported(bare):
    sentence = the_one_sentence(bare.course('lab'))
    assert 'Python 3.11, 3.12 or 3.13 is needed, and none is installed: install one' in sentence


@pytest.mark.parametrize(
    ('change', 'fault'),
    [
        ('sys.version_info = (3, 10, 13)', 'python3 is 3.10.13, too old'),
        ('sys.version_info = (3, 14, 0)', 'python3 is 3.14.0, too new'),
        ('sys.implementation.name = "pypy"', 'not CPython'),
        ('sys.maxsize = 2**31 - 1', 'a 32-bit one'),
        ('import sysconfig; sysconfig.get_config_var = lambda name: 1', 'a free-threaded one'),
        ('import os; os.confstr = lambda name: "glibc 2.27"', 'without glibc 2.28'),
        ('import os; os.confstr = lambda name: None', 'without glibc 2.28'),
    ],
)
def test_an_unsuitable_python_is_reported_with_its_fault(bare, change, fault):
    bare.program(
        'python3', f'exec {shlex.quote(sys.executable)} -Ic \'import sys; {change}\n\'"$2"'
    )
    sentence = the_one_sentence(bare.course('lab'))
    assert fault in sentence
    assert 'install one' in sentence


def test_a_suitable_python_is_found_behind_unsuitable_ones(machine):
    machine.program('python3', 'echo "pyenv: python3: command not found" >&2; exit 127')
    machine.program('python3.13', 'echo "3.13.0 a free-threaded one"')
    machine.program('python3.12', PYTHON)
    machine.program('uv', UV.replace('command -v python3', 'command -v python3.12'))
    assert machine.course('scores').returncode == 0
    assert f'--python {machine.programs}/python3.12' in machine.calls('uv venv')[0]


@pytest.mark.parametrize('python', ['/nowhere/python3', 'false'])
def test_a_python_named_by_the_user_that_does_not_run_is_reported(machine, python):
    assert f'PYTHON={python} does not run' in the_one_sentence(
        machine.course('lab', PYTHON=python)
    )


def test_a_missing_venv_module_is_reported(machine):
    (machine.programs / 'uv').unlink()
    machine.program('python3', PYTHON.replace('*ensurepip*) ;;', '*ensurepip*) exit 1 ;;'))
    sentence = the_one_sentence(machine.course('lab'))
    assert 'no venv module' in sentence
    assert 'apt install python3.12-venv' in sentence


@pytest.mark.parametrize(
    ('complaint', 'said'),
    [
        ('ERROR: Could not install: [Errno 28] No space left on device', 'the disk is full'),
        ('error: failed to copy file: No space left on device (os error 28)', 'the disk is full'),
        ('OSError: [Errno 122] Disk quota exceeded', 'the disk is full'),
        (
            'Caused by: error sending request for url (https://registry/simple/)',
            'cannot be reached',
        ),
        ("WARNING: Retrying after 'NewConnectionError(...)': /simple/six/", 'cannot be reached'),
    ],
)
def test_the_installers_complaint_becomes_one_sentence(machine, complaint, said):
    machine.program(
        'uv', UV + f'case $1 in pip) echo {shlex.quote(complaint)} >&2; exit 1 ;; esac'
    )
    assert said in the_one_sentence(machine.course('lab'))


def test_an_unknown_complaint_of_the_installer_is_shown(machine):
    machine.program('uv', UV + 'case $1 in pip) echo "the moon is full" >&2; exit 1 ;; esac')
    run = machine.course('lab')
    assert run.returncode == 1
    assert 'the moon is full' in run.stderr
    assert 'setting up failed for the reason above' in run.stderr.splitlines()[-1]


@pytest.fixture
def real(bare):
    """A machine with the Python and the uv that run this test."""
    bare.program('python3', f'exec {shlex.quote(sys._base_executable)} "$@"')
    bare.program('uv', f'exec {shlex.quote(sys.prefix)}/bin/uv "$@"')
    return bare


# an ordinary run has set itself up by one of them, and `--slow` tests the other, too
INSTALLERS = ['uv', pytest.param('pip', marks=pytest.mark.slow)]


def in_a_namespace(*flags):
    command = [*IN_A_NAMESPACE, *flags]
    probe = subprocess.run([*command, 'true'], capture_output=True, text=True)
    if probe.returncode:
        pytest.skip(f'needs root or user namespaces: {probe.stderr.strip()}')
    return command


@pytest.mark.parametrize('installer', INSTALLERS)
def test_a_missing_network_is_reported(real, installer, tmp_path):
    if installer == 'pip':
        (real.programs / 'uv').unlink()
    empty = {'UV_CACHE_DIR': tmp_path / 'uv', 'PIP_CACHE_DIR': tmp_path / 'pip'}
    alone = in_a_namespace('--net')
    sentence = the_one_sentence(
        real.course('lab', before=alone, UV_HTTP_RETRIES=0, PIP_RETRIES=1, **empty)
    )
    assert 'the package registry cannot be reached' in sentence
    assert not (real.root / '.venv/made_environment').exists()


@pytest.mark.parametrize('installer', INSTALLERS)
def test_a_full_disk_is_reported(real, installer, tmp_path):
    if installer == 'pip':
        (real.programs / 'uv').unlink()
    disk = tmp_path / 'disk'
    disk.mkdir()
    moved = disk / 'my course'
    on_a_small_disk = (
        'mount -t tmpfs -o size=2m tmpfs "$1" && cp -r "$2" "$1" && "$3/course" lab; code=$?; '
        'test -e "$3/.venv/made_environment" && echo half-made; exit $code'
    )
    bash = shutil.which('bash')
    (real.programs / 'mount').symlink_to(shutil.which('mount'))
    run = real.course(
        *('-c', on_a_small_disk, 'bash', disk, real.root, moved),
        before=in_a_namespace(),
        script=bash,
    )
    assert 'the disk is full: free some space' in the_one_sentence(run)
    assert run.stdout == ''


def test_a_read_only_folder_is_reported(machine):
    read_only = 'mount --bind "$1" "$1" && mount -o remount,ro,bind "$1" && exec "$1/course" lab'
    (machine.programs / 'mount').symlink_to(shutil.which('mount'))
    run = machine.course(
        *('-c', read_only, 'bash', machine.root),
        before=in_a_namespace(),
        script=shutil.which('bash'),
    )
    assert f'the folder {machine.root} is read-only: copy' in the_one_sentence(run)


# --- with the real installers --------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.parametrize('installer', ['uv', 'pip'])
def test_the_real_installers_set_up_a_working_environment(real, installer, tmp_path):
    if installer == 'pip':
        (real.programs / 'uv').unlink()
    (real.root / 'grader/__main__.py').write_text(
        'import sys, grader, my_robot_basics\n'
        'print(sys.prefix, sys.argv[1:], grader.__file__, my_robot_basics.__file__)\n'
    )
    link = real.programs / 'course'
    link.symlink_to(real.root / 'course')
    # what an earlier run has built would hide that it cannot be built
    empty = {'UV_CACHE_DIR': tmp_path / 'uv', 'PIP_CACHE_DIR': tmp_path / 'pip'}
    arguments = ('grade', '03_publisher', '--student', 'Ada L.')
    run = real.course(*arguments, script=link, PIP_USER=1, **empty)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split('\n')[0] == (
        f"{real.root}/.venv ['grade', '03_publisher', '--student', 'Ada L.'] "
        f'{real.root}/grader/__init__.py {real.root}/my_robot_basics/my_robot_basics/__init__.py'
    )
    assert real.course('grade').stderr == ''
