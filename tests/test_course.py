"""`./course`: its help, the verbs that it starts, its language, and what a bundle has of it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from course_machine import ROOT, Machine, the_one_sentence, with_programs

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


@pytest.fixture
def bare(tmp_path):
    """A machine with neither Python nor uv."""
    return Machine(tmp_path)


@pytest.fixture
def machine(bare):
    """A machine with a Python and a uv that only record their arguments."""
    return with_programs(bare)


# --- the script itself ---------------------------------------------------------------------------

TERMINAL = 'my_robot_basics/my_robot_basics/ros2/terminal.bash'


@pytest.mark.parametrize('script', ['course', 'launcher/words.sh', '.ci/run', TERMINAL])
def test_shellcheck_finds_no_fault_in_a_script(script):
    shellcheck = Path(sys.prefix, 'bin/shellcheck')
    run = subprocess.run(
        [shellcheck, '--external-sources', ROOT / script], cwd=ROOT, capture_output=True, text=True
    )
    assert (run.returncode, run.stdout) == (0, '')


def test_the_shell_script_that_runs_before_python_is_short():
    """Everything that can be written in Python is Python, and is tested as such."""
    assert len((ROOT / 'course').read_text(encoding='utf-8').splitlines()) <= 120


@pytest.mark.parametrize('shell', ['dash', 'bash --posix', 'busybox sh'])
def test_the_course_script_works_under_any_posix_shell(machine, shell):
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


def test_a_call_without_a_verb_lists_the_verbs(bare):
    run = bare.course()
    assert run.returncode == 2
    assert run.stderr == bare.course('--help').stdout


def test_an_unknown_verb_is_named_and_sets_nothing_up(machine):
    run = machine.course('grde')
    assert (run.returncode, run.stdout) == (2, '')
    assert "no verb 'grde'" in run.stderr
    assert not (machine.root / '.venv').exists()


# --- what a verb starts --------------------------------------------------------------------------


def test_variables_of_other_ros_environments_are_not_passed_on(machine):
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
        "--KernelSpecManager.allowed_kernelspecs={'python3'} "
        "--ServerApp.jpserver_extensions={'nbgrader.server_extensions.formgrader': False}"
    )
    arguments = [served, for_students, *root, '--no-browser --port 1234']
    command, terminal = re.subn(r' --ServerApp\.terminado_settings=\{.*?\}', '', command)
    assert (command, terminal) == (' '.join(['python -P -m jupyterlab', *arguments]), 1)
    assert folder == f'{machine.root}/notebooks'


def test_lab_links_an_existing_workspace_into_its_file_browser(machine):
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


def test_lab_limits_the_discovery_of_nodes_to_this_machine(machine):
    run = machine.course('lab', PRINT_ENVIRONMENT='yes')
    assert 'ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST' in run.stdout.splitlines()


def test_a_path_to_collect_is_relative_to_the_caller_s_folder(machine):
    assert machine.course('collect', 'class.zip').returncode == 0
    assert machine.calls()[-2:] == ['python -P -m grader collect class.zip', '/']


@pytest.mark.parametrize(
    ('verb', 'module', 'folder'),
    [
        ('workspace', 'live.packages.workspace', '{root}'),
        ('ros-shell', 'ros2.shell', '/'),
        ('validate', 'validate', '/'),
    ],
)
def test_workspace_shell_and_validate_run_modules_of_the_students_package(
    machine, verb, module, folder
):
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


def test_a_language_without_lessons_is_reported_with_the_available_languages(machine):
    machine.course('scores')
    said = the_one_sentence(machine.course('lab', '--language', 'tlh'))
    assert "there are no lessons in 'tlh': --language takes en" in said


def test_lab_without_lessons_says_what_to_do(machine):
    machine.course('scores')
    (machine.root / 'notebooks').rmdir()
    assert './course release' in the_one_sentence(machine.course('lab'))


# --- the students' bundle: the same script, without a grader -------------------------------------
@pytest.fixture
def bundle(machine):
    """A course without its grader and what belongs to it."""
    shutil.rmtree(machine.root / 'grader')
    (machine.root / 'pyproject.toml').unlink()
    return machine


def test_the_help_of_a_bundle_lists_only_the_verbs_of_students(bundle):
    run = bundle.course('--help')
    assert (run.returncode, run.stderr) == (0, '')
    verbs = [line.split()[0] for line in run.stdout.splitlines() if line.startswith('  ')]
    assert verbs == ['lab', 'validate', 'progress', 'workspace', 'ros-shell', 'wheels', 'hub']


@pytest.mark.parametrize('verb', VERBS[7:])
def test_an_instructors_verb_in_a_bundle_is_refused_without_setting_up(bundle, verb):
    sentence = the_one_sentence(bundle.course(verb))
    assert sentence.startswith(f"'{verb}' is for instructors and needs the whole course")
    assert not (bundle.root / '.venv').exists()


def test_a_bundle_installs_the_students_package_and_no_grader(bundle):
    assert bundle.course('lab').returncode == 0
    (*_, installed) = bundle.calls('uv pip install')
    wheel = './arm_interfaces/wheel/arm_interfaces-0.1.0-cp311-abi3-manylinux_2_28_x86_64.whl'
    assert installed.endswith(f' --force-reinstall -e ./my_robot_basics {wheel}')
    assert bundle.course('lab').stderr == ''


@pytest.mark.starts
@pytest.mark.parametrize('name', ['ros2', 'topic_doctor'])
def test_ros2_and_topic_doctor_start_the_tools_of_the_installed_package(bundle, name):
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
