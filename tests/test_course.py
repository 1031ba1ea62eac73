import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
VERBS = [
    'lab',
    'validate',
    'progress',
    'workspace',
    'ros-shell',
    'wheels',
    'hub',
    'test',
    'release',
    'bundle',
    'translate',
]
VERBS += ['collect', 'due', 'grade', 'serve', 'scores', 'feedback', 'solutions', 'demo', 'doctor']
TOOLS = ['sh', 'cat', 'chmod', 'cp', 'dirname', 'env', 'mkdir', 'readlink', 'sleep', 'uname']
IN_A_NAMESPACE = [
    shutil.which('unshare'),
    '--mount',
    *([] if os.geteuid() == 0 else ['--map-root-user']),
]

PYTHON = (
    f"""\
case $* in '-IS '*/launcher' '*) exec {shlex.quote(sys._base_executable)} "$@" ;; esac
"""
    """\
echo "python $*" >>"$CALLS"
case $* in
    *CS_GNU_LIBC*) echo '3.12.1 ' ;;
    -ISc*) echo 3.12.1 ;;
    *ensurepip*) ;;
    '-m venv'*) mkdir -p "$4/bin" && cp "$0" "$4/bin/python" ;;
    *'-m pip'*) ;;
    *) pwd >>"$CALLS"; [ -z "${PRINT_ENVIRONMENT:-}" ] || env ;;
esac
"""
)
"""A Python that runs the launcher, and of all else only writes down what it is asked for."""

UV = """\
echo "uv $*" >>"$CALLS"
case $1 in venv) mkdir -p "$4/bin" && cp "$(command -v python3)" "$4/bin/python" ;; esac
"""


class Machine:
    """A small course in a folder with a space in its name, and all the programs there are."""

    def __init__(self, folder):
        self.root = folder / 'my course'
        self.programs = folder / 'programs'
        self.calls_file = folder / 'calls'
        self.programs.mkdir()
        for tool in TOOLS:
            (self.programs / tool).symlink_to(shutil.which(tool))
        package = self.root / 'my_robot_basics/my_robot_basics'
        package.mkdir(parents=True)
        (package / '__init__.py').touch()
        (self.root / 'grader').mkdir()
        (self.root / 'grader/__init__.py').touch()
        shutil.copytree(
            ROOT / 'grader/kernels/kernelspec', self.root / 'grader/kernels/kernelspec'
        )
        button = 'my_robot_basics/my_robot_basics/validate/labextension'
        shutil.copytree(ROOT / button, self.root / button)
        unmade = shutil.ignore_patterns('__pycache__')
        shutil.copytree(ROOT / 'launcher', self.root / 'launcher', ignore=unmade)
        (self.root / 'notebooks').mkdir()
        for name in ('package.xml', 'setup.py', 'setup.cfg'):
            shutil.copy(ROOT / 'my_robot_basics' / name, package.parent)
        shutil.copytree(ROOT / 'arm_interfaces', self.root / 'arm_interfaces')
        for name in ('course', 'pyproject.toml', 'LICENSE', 'README.md'):
            shutil.copy(ROOT / name, self.root)
        (package.parent / 'resource').mkdir()
        (package.parent / 'resource/my_robot_basics').touch()
        pins = re.split(r'^(?=\w)', (ROOT / 'environment.txt').read_text(), flags=re.MULTILINE)
        # empy exists as source alone
        needed = [pin for pin in pins if pin.startswith(('pip==', 'setuptools==', 'empy=='))]
        (self.root / 'environment.txt').write_text(''.join(needed))

    def program(self, name, script):
        """Put a program in the PATH, or another in its place."""
        path = self.programs / name
        path.unlink(missing_ok=True)
        path.write_text(f'#!/bin/sh\n{script}\n')
        path.chmod(0o755)

    def course(self, *arguments, before=(), script=None, **environment):
        self.calls_file.write_text('')
        others = ('PYTHON', 'MY_ROBOT_BASICS_WORKSPACE')
        clean = {k: v for k, v in os.environ.items() if k not in others}
        return subprocess.run(
            [*before, script or self.root / 'course', *arguments],
            cwd='/',
            env=clean
            | {'PATH': str(self.programs), 'CALLS': str(self.calls_file)}
            | {k: str(v) for k, v in environment.items()},
            capture_output=True,
            text=True,
            timeout=240,
        )

    def calls(self, beginning=''):
        lines = self.calls_file.read_text().splitlines()
        return [line for line in lines if line.startswith(beginning)]


@pytest.fixture
def bare(tmp_path):
    """A machine with neither Python nor uv."""
    return Machine(tmp_path)


@pytest.fixture
def machine(bare):
    """A machine with a Python and a uv that only write down what they are asked for."""
    bare.program('python3', PYTHON)
    bare.program('uv', UV)
    return bare


def the_one_sentence(run):
    """The last line, where nothing but progress and notes of the script's own came before."""
    lines = run.stderr.splitlines()
    assert run.returncode == 1, run
    assert all(line.startswith(('course: setting up', '  ')) for line in lines[:-1]), run.stderr
    assert lines[-1].startswith('course: ')
    assert lines[-1].endswith('.')
    return lines[-1].removeprefix('course: ')


# --- the script itself ---------------------------------------------------------------------------


TERMINAL = 'my_robot_basics/my_robot_basics/ros2/terminal.bash'


@pytest.mark.parametrize('script', ['course', 'launcher/words.sh', '.ci/run', TERMINAL])
def test_shellcheck_finds_nothing(script):
    shellcheck = Path(sys.prefix, 'bin/shellcheck')
    run = subprocess.run(
        [shellcheck, '--external-sources', ROOT / script], cwd=ROOT, capture_output=True, text=True
    )
    assert (run.returncode, run.stdout) == (0, '')


def test_what_runs_before_there_is_a_python_is_short():
    """What can be Python is tested as such."""
    assert len((ROOT / 'course').read_text(encoding='utf-8').splitlines()) <= 120


@pytest.mark.parametrize('shell', ['dash', 'bash --posix', 'busybox sh'])
def test_works_under_any_posix_shell(machine, shell):
    program, *options = shell.split()
    if not (path := shutil.which(program)):
        pytest.skip(f'{program} is not installed')
    run = machine.course('scores', before=[path, *options])
    assert run.returncode == 0, run.stderr
    assert machine.calls('python -P -m grader scores')


@pytest.mark.parametrize('asked', ['--help', '-h', 'help'])
def test_help_has_a_line_for_each_verb(bare, asked):
    run = bare.course(asked)
    assert (run.returncode, run.stderr) == (0, '')
    lines = [line.split() for line in run.stdout.splitlines() if re.match(r'  \S', line)]
    assert [words[0] for words in lines] == VERBS
    assert all(len(words) >= 3 for words in lines)
    assert 'grade [ASSIGNMENT] [--student ID]' in run.stdout


def test_without_a_verb_the_verbs_are_listed(bare):
    run = bare.course()
    assert run.returncode == 2
    assert run.stderr == bare.course('--help').stdout


def test_an_unknown_verb_is_named_and_sets_nothing_up(machine):
    run = machine.course('grde')
    assert (run.returncode, run.stdout) == (2, '')
    assert "no verb 'grde'" in run.stderr
    assert not (machine.root / '.venv').exists()


# --- when it sets up -----------------------------------------------------------------------------


def test_first_call_sets_up_and_the_second_does_nothing(machine):
    first = machine.course('scores')
    assert first.returncode == 0, first.stderr
    assert len(machine.calls('uv venv')) == 1
    assert len(machine.calls('uv pip install')) == 3  # build tools, pins, our own
    second = machine.course('scores')
    assert (second.returncode, second.stderr) == (0, '')
    assert not machine.calls('uv')
    assert machine.calls('python -P')


def test_without_uv_pip_does_the_same(machine):
    (machine.programs / 'uv').unlink()
    assert machine.course('scores').returncode == 0
    assert len(machine.calls('python -m venv')) == 1
    assert len(machine.calls('python -m pip install')) == 3
    assert machine.course('scores').stderr == ''


def test_a_uv_that_does_not_run_is_no_uv(machine):
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
def test_sets_up_again_after(happening, machine):
    machine.course('scores')
    leftover = machine.root / '.venv/leftover'
    leftover.touch()
    happening(machine)
    run = machine.course('scores')
    assert run.returncode == 0, run.stderr
    assert len(machine.calls('uv venv')) == 1
    assert not (machine.root / '.venv/leftover').exists()
    assert machine.course('scores').stderr == ''


def test_another_python_asked_for_is_set_up(machine):
    machine.course('scores')
    machine.program('other', re.sub(r"(echo '?)3\.12\.1", r'\g<1>3.13.0', PYTHON))
    run = machine.course('scores', PYTHON='other')
    assert 'with Python 3.13.0' in run.stderr


def test_new_entry_points_are_installed_without_making_all_again(machine):
    machine.course('scores')
    with (machine.root / 'my_robot_basics/setup.py').open('a') as file:
        file.write('# another console script\n')
    assert machine.course('scores').returncode == 0
    assert not machine.calls('uv venv')
    assert [
        call for call in machine.calls('uv pip install') if '-e ./my_robot_basics -e .' in call
    ]
    assert machine.course('scores').stderr == ''


def test_another_wheel_of_the_same_version_is_installed(machine):
    machine.course('scores')
    machine.calls('uv')
    (wheel,) = machine.root.glob('arm_interfaces/wheel/*.whl')
    with wheel.open('ab') as file:
        file.write(b'changed')
    assert machine.course('scores').returncode == 0
    assert [call for call in machine.calls('uv pip install') if call.endswith(f'/{wheel.name}')]
    assert machine.course('scores').stderr == ''


def test_without_its_wheel_the_course_says_what_is_missing(machine):
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


# --- where it can't work -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('system', 'processor'),
    [('Darwin', 'arm64'), ('Linux', 'aarch64'), ('MINGW64_NT-10.0', 'x86_64')],
)
def test_another_machine_is_named(bare, system, processor):
    bare.program('uname', f'case $1 in -s) echo {system} ;; *) echo {processor} ;; esac')
    sentence = the_one_sentence(bare.course('lab'))
    assert f'{system} on {processor}' in sentence
    assert 'use such a machine' in sentence


def test_no_python_is_said(bare):
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
def test_a_python_that_does_not_fit_is_named(bare, change, fault):
    bare.program(
        'python3', f'exec {shlex.quote(sys.executable)} -Ic \'import sys; {change}\n\'"$2"'
    )
    sentence = the_one_sentence(bare.course('lab'))
    assert fault in sentence
    assert 'install one' in sentence


def test_a_python_that_fits_is_found_behind_those_that_do_not(machine):
    machine.program('python3', 'echo "pyenv: python3: command not found" >&2; exit 127')
    machine.program('python3.13', 'echo "3.13.0 a free-threaded one"')
    machine.program('python3.12', PYTHON)
    machine.program('uv', UV.replace('command -v python3', 'command -v python3.12'))
    assert machine.course('scores').returncode == 0
    assert f'--python {machine.programs}/python3.12' in machine.calls('uv venv')[0]


@pytest.mark.parametrize('python', ['/nowhere/python3', 'false'])
def test_a_python_asked_for_that_does_not_run_is_named(machine, python):
    assert f'PYTHON={python} does not run' in the_one_sentence(
        machine.course('lab', PYTHON=python)
    )


def test_a_missing_venv_module_is_said(machine):
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


def test_an_unknown_complaint_is_shown(machine):
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
def test_without_a_network_says_so(real, installer, tmp_path):
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
def test_a_full_disk_says_so(real, installer, tmp_path):
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


def test_a_read_only_folder_says_so(machine):
    read_only = 'mount --bind "$1" "$1" && mount -o remount,ro,bind "$1" && exec "$1/course" lab'
    (machine.programs / 'mount').symlink_to(shutil.which('mount'))
    run = machine.course(
        *('-c', read_only, 'bash', machine.root),
        before=in_a_namespace(),
        script=shutil.which('bash'),
    )
    assert f'the folder {machine.root} is read-only: copy' in the_one_sentence(run)


# --- what it starts ------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize('installer', ['uv', 'pip'])
def test_really_sets_up(real, installer, tmp_path):
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


def test_other_environments_stay_outside(machine):
    ros, workspace, venv = '/opt/ros/jazzy', '/home/ada/ros ws/install', machine.root / '.venv'
    run = machine.course(
        'scores',
        PRINT_ENVIRONMENT='yes',
        PATH=f'{venv}/bin:{ros}/bin:{workspace}/arm/bin:{machine.programs}:/opt/rosy',
        PYTHONPATH=f'{ros}/lib/python3.12/site-packages',
        LD_LIBRARY_PATH=f'{ros}/lib:/usr/local/cuda/lib64:{workspace}/arm/lib',
        AMENT_PREFIX_PATH=f'{workspace}/arm:{ros}',
        COLCON_PREFIX_PATH=workspace,
        RMW_IMPLEMENTATION='rmw_cyclonedds_cpp',
        ROS_DISTRO='jazzy',
        ROS_DOMAIN_ID='7',
        ROS_LOCALHOST_ONLY='1',
        ROS_LOG_DIR='/var/log/ros',
        ROS_WS='/home/ada/ros ws',
        _ROS_WHEELS_BOOTSTRAP_COMPLETE='1',
    )
    seen = dict(line.split('=', 1) for line in run.stdout.splitlines() if '=' in line)
    assert seen['PATH'] == f'{venv}/bin:{machine.programs}:/opt/rosy'
    assert seen['AMENT_PREFIX_PATH'] == seen['VIRTUAL_ENV'] == str(venv)
    assert seen['LD_LIBRARY_PATH'] == '/usr/local/cuda/lib64'
    assert seen['RCUTILS_LOGGING_USE_STDOUT'] == '1'
    assert seen['RCUTILS_COLORIZED_OUTPUT'] == '0'
    ros_names = {name for name in seen if name.startswith(('ROS_', '_ROS', 'RMW', 'COLCON'))}
    assert ros_names == {'ROS_LOG_DIR', 'ROS_WS', 'COLCON_PYTHON_EXECUTABLE'}
    assert seen['ROS_WS'] == f'{machine.root}/ros_ws'
    assert 'PYTHONPATH' not in seen


def test_lab_serves_the_lessons_alone(machine):
    assert machine.course('lab', '--no-browser', '--port', '1234').returncode == 0
    command, folder = machine.calls()[-2:]
    root = ['--allow-root'] if os.geteuid() == 0 else []
    served = f'--ServerApp.root_dir={machine.root}/notebooks'
    served += ' --LabApp.default_url=/lab/tree/index.ipynb'
    for_students = (
        f'--LabApp.app_settings_dir={machine.root}/.jupyterlab '
        "--ServerApp.jpserver_extensions={'nbgrader.server_extensions.formgrader': False}"
    )
    arguments = [served, for_students, *root, '--no-browser --port 1234']
    command, terminal = re.subn(r' --ServerApp\.terminado_settings=\{.*?\}', '', command)
    assert (command, terminal) == (' '.join(['python -P -m jupyterlab', *arguments]), 1)
    assert folder == f'{machine.root}/notebooks'


def test_lab_shows_a_workspace_that_is_there_in_its_file_browser(machine):
    link = machine.root / 'notebooks/ros_ws'
    assert machine.course('lab').returncode == 0
    assert not link.is_symlink()
    (machine.root / 'ros_ws/src').mkdir(parents=True)
    for _ in range(2):
        assert machine.course('lab').returncode == 0
        assert link.readlink() == Path('../ros_ws')
        assert (link / 'src').is_dir()
    edition = machine.root / 'notebooks/zh_CN'
    edition.mkdir()
    (edition / 'index.ipynb').touch()
    assert machine.course('lab').returncode == 0
    assert (edition / 'ros_ws').readlink() == Path('../../ros_ws')
    link.unlink()
    link.write_text('mine')
    assert machine.course('lab').returncode == 0
    assert link.read_text() == 'mine'


def test_what_lab_starts_is_on_this_machine_alone(machine):
    run = machine.course('lab', PRINT_ENVIRONMENT='yes')
    assert 'ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST' in run.stdout.splitlines()


def test_a_path_to_collect_is_the_caller_s(machine):
    assert machine.course('collect', 'class.zip').returncode == 0
    assert machine.calls()[-2:] == ['python -P -m grader collect class.zip', '/']


@pytest.mark.parametrize(
    ('verb', 'module', 'folder'),
    [
        ('workspace', 'live.workspace', '{root}'),
        ('ros-shell', 'ros2.shell', '/'),
        ('validate', 'validate', '/'),
    ],
)
def test_workspace_and_shell_are_the_packages(machine, verb, module, folder):
    run = machine.course(verb, '-c', 'two words')
    assert run.returncode == 0, run.stderr
    assert machine.calls()[-2:] == [
        f'python -P -m my_robot_basics.{module} -c two words',
        folder.format(root=machine.root),
    ]


CHINESE = {'LANG': 'zh_CN.UTF-8', 'LC_ALL': '', 'LC_MESSAGES': ''}
LANGUAGES = {
    'by the locale': ([], CHINESE, 'zh_CN/index.ipynb'),
    'by another locale of the language': ([], CHINESE | {'LANG': 'zh_SG'}, 'zh_CN/index.ipynb'),
    'by the strongest variable': ([], CHINESE | {'LC_ALL': 'de_DE'}, 'index.ipynb'),
    'in no locale at all': ([], CHINESE | {'LANG': 'C.UTF-8'}, 'index.ipynb'),
    'asked for': (['--language', 'zh_CN'], {'LANG': 'C'}, 'zh_CN/index.ipynb'),
    'asked for otherwise': (['--language=en'], CHINESE, 'index.ipynb'),
}


@pytest.mark.parametrize(('asked', 'locale', 'page'), LANGUAGES.values(), ids=LANGUAGES)
def test_lab_opens_the_lessons_in_the_language_of_its_user(machine, asked, locale, page):
    edition = machine.root / 'notebooks/zh_CN'
    edition.mkdir()
    (edition / 'index.ipynb').touch()
    assert machine.course('lab', *asked, **locale).returncode == 0
    (command,) = (call for call in machine.calls() if '-m jupyterlab' in call)
    assert f'--LabApp.default_url=/lab/tree/{page} ' in command
    assert f'--LabApp.app_settings_dir={machine.root}/.jupyterlab ' in command  # no language pack
    assert '--language' not in command


def test_a_language_without_lessons_is_named_with_those_there_are(machine):
    machine.course('scores')
    said = the_one_sentence(machine.course('lab', '--language', 'tlh'))
    assert "there are no lessons in 'tlh': --language takes en" in said


def test_lab_without_lessons_says_what_to_do(machine):
    machine.course('scores')
    (machine.root / 'notebooks').rmdir()
    assert './course release' in the_one_sentence(machine.course('lab'))


def checks(machine, *arguments, ruff=0, mypy=0, pytest=0, again=None):
    """Run ./course test with checks that end so; return its exit code and its calls of pytest."""
    again = pytest if again is None else again
    machine.course('scores')
    bin_folder = machine.root / '.venv/bin'
    for tool, ends in (('ruff', ruff), ('mypy', mypy)):
        (bin_folder / tool).write_text(f'#!/bin/sh\nexit {ends}\n')
        (bin_folder / tool).chmod(0o755)
    (bin_folder / 'python').write_text(
        f'#!/bin/sh\n{PYTHON}\n'
        f'case $* in *--last-failed*) exit {again} ;; *pytest*) exit {pytest} ;; esac\n'
    )
    run = machine.course('test', *arguments)
    calls = [call for call in machine.calls('python') if 'pytest' in call]
    return run.returncode, [call for call in calls if '--collect-only' not in call]


@pytest.mark.parametrize(
    ('ruff', 'mypy', 'pytest', 'code'),
    [
        (0, 0, 0, 0),
        (1, 0, 0, 1),
        (0, 2, 0, 2),
        (1, 2, 0, 2),
        (0, 0, 1, 1),
        (0, 0, 5, 5),
        (1, 2, 3, 3),
    ],
)
def test_test_ends_with_the_last_failure(machine, ruff, mypy, pytest, code):
    seen, calls = checks(machine, ruff=ruff, mypy=mypy, pytest=pytest)
    assert seen == code
    assert len(calls) == (2 if pytest == 1 else 1)


@pytest.mark.parametrize('again', [0, 1, 5])
def test_what_failed_beside_other_tests_is_judged_alone(machine, again):
    seen, calls = checks(machine, '-k', 'a name', pytest=1, again=again)
    assert seen == again
    assert '-k a name --last-failed -n 0' in calls[-1]


def test_test_passes_arguments_on(machine):
    _, [call] = checks(machine, '--slow', '-k', 'a name')
    assert call.endswith(' --slow -k a name')


@pytest.mark.parametrize('again', [0, 1, 5])
def test_a_lesson_that_differed_beside_others_is_judged_alone_and_whole(machine, again):
    for name in ('00_lesson', '01_lesson'):
        lesson = machine.root / f'solutions/{name}/{name}.ipynb'
        lesson.parent.mkdir(parents=True)
        lesson.touch()
    remembered = machine.root / '.pytest_cache/lessons/v/cache/lastfailed'
    remembered.parent.mkdir(parents=True)
    cells = [f'solutions/01_lesson/01_lesson.ipynb::Cell {n}' for n in (3, 5)]
    failed = dict.fromkeys(['tests/test_x.py::test_y', *cells], True)
    remembered.write_text(json.dumps(failed, indent=2))
    machine.course('scores')
    for tool in ('ruff', 'mypy'):
        (machine.root / '.venv/bin' / tool).write_text('#!/bin/sh\n')
        (machine.root / '.venv/bin' / tool).chmod(0o755)
    ends = f'*--nbval*-n\\ 0*) exit {again} ;; *--nbval*) exit 1 ;;'
    python = machine.root / '.venv/bin/python'
    python.write_text(f'#!/bin/sh\n{PYTHON}\ncase $* in {ends} esac\n')
    run = machine.course('test')
    assert run.returncode == again
    assert machine.calls('python')[-1].endswith(' -v -n 0 solutions/01_lesson/01_lesson.ipynb')


def test_test_replays_the_lessons_when_it_checks_everything(machine):
    lesson = machine.root / 'solutions/00_lesson/00_lesson.ipynb'
    lesson.parent.mkdir(parents=True)
    lesson.touch()
    assert sorted('--nbval' in call for call in checks(machine)[1]) == [False, True]
    assert sorted('--nbval' in call for call in checks(machine, '--slow')[1]) == [False, True]
    assert ['--nbval' in call for call in checks(machine, 'tests/test_x.py')[1]] == [False]


@pytest.mark.parametrize('code', [0, 1, 5])
def test_ci_gets_what_is_missing_and_ends_as_the_tests_do(bare, code):
    (bare.root / '.ci').mkdir()
    run_script = Path(shutil.copy(ROOT / '.ci/run', bare.root / '.ci/run'))
    (bare.root / 'course').write_text(f'#!/bin/sh\necho "course $*" >>"$CALLS"\nexit {code}\n')
    bare.program('apt-get', 'echo "apt-get $*" >>"$CALLS"')
    bare.program('chromium', '')
    (bare.programs / 'bash').symlink_to(shutil.which('bash'))
    run = bare.course(script=run_script)
    assert run.returncode == code
    packages = ['apt-get update', 'apt-get install'] if os.geteuid() == 0 else []
    assert [call.split(' -')[0] for call in bare.calls()] == [*packages, 'course test']
    if packages:
        assert bare.calls('apt-get install')[0].endswith(' bubblewrap')


# --- the students' bundle: the same script, without a grader -------------------------------------


@pytest.fixture
def bundle(machine):
    """A course without its grader and what belongs to it."""
    shutil.rmtree(machine.root / 'grader')
    (machine.root / 'pyproject.toml').unlink()
    return machine


def test_in_a_bundle_help_lists_what_a_student_can_do(bundle):
    run = bundle.course('--help')
    assert (run.returncode, run.stderr) == (0, '')
    verbs = [line.split()[0] for line in run.stdout.splitlines() if line.startswith('  ')]
    assert verbs == ['lab', 'validate', 'progress', 'workspace', 'ros-shell', 'wheels', 'hub']


@pytest.mark.parametrize('verb', VERBS[7:])
def test_in_a_bundle_an_instructors_verb_says_so_and_sets_nothing_up(bundle, verb):
    sentence = the_one_sentence(bundle.course(verb))
    assert sentence.startswith(f"'{verb}' is for instructors and needs the whole course")
    assert not (bundle.root / '.venv').exists()


def test_in_a_bundle_only_the_students_package_is_installed(bundle):
    assert bundle.course('lab').returncode == 0
    (*_, installed) = bundle.calls('uv pip install')
    wheel = './arm_interfaces/wheel/arm_interfaces-0.1.0-cp311-abi3-manylinux_2_28_x86_64.whl'
    assert installed.endswith(f' --force-reinstall -e ./my_robot_basics {wheel}')
    assert bundle.course('lab').stderr == ''


@pytest.mark.starts
@pytest.mark.parametrize('name', ['ros2', 'topic_doctor'])
def test_the_tools_are_those_of_the_installed_package_wherever_it_lies(bundle, name):
    tools = bundle.root / 'my_robot_basics/my_robot_basics/ros2'
    tools.mkdir()
    (tools / 'start.py').touch()
    assert bundle.course('lab').returncode == 0
    script = bundle.root / '.venv/bin' / name
    run = bundle.course('topic', 'two words', script=script)
    assert run.returncode == 0, run.stderr
    module = {'ros2': 'ros2.main', 'topic_doctor': 'doctor.main'}[name]
    start = f'{script.parent}/../../my_robot_basics/my_robot_basics/ros2/start.py'
    assert bundle.calls()[0] == f'python -P {start} {module} topic two words'
