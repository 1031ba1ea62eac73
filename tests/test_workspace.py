"""The student's colcon workspace: what is made, what is kept, and what a terminal builds in it."""

import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from jupyter_client.manager import start_new_kernel
from my_robot_basics.language.speaking import OF_TERMINALS
from my_robot_basics.live.packages import workspace
from my_robot_basics.live.packages.workspace import make_workspace
from my_robot_basics.session import classroom
from ros2_command import own_domain

ROOT = Path(__file__).parents[1]
BUILD = 'colcon build --packages-select my_robot_basics >log.txt 2>&1 || cat log.txt\n'
SOURCE = 'source install/setup.bash\n'
TIMEOUT_SEC = 120


def ros2_run(executable, until):
    """Lines for a shell: start an executable, wait for a word of its output, end it, print all."""
    return (
        f'ros2 run my_robot_basics {executable} >said.txt 2>&1 & pid=$!\n'
        f'while kill -0 $pid && ! grep -q "{until}" said.txt; do sleep 0.1; done 2>kill.txt\n'
        'kill -TERM $pid 2>kill.txt; wait $pid; cat said.txt\n'
    )


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty place for a workspace, with a space in its name."""
    folder = tmp_path / 'ros ws'
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(folder))
    return folder


@pytest.fixture
def package(folder):
    """The student's copy, in a workspace that was made."""
    make_workspace()
    return folder / 'src/my_robot_basics'


def shell(script, **environment):
    """What a script prints in bash under `./course ros-shell`, in the workspace."""
    done = subprocess.run(
        [
            sys.executable,
            '-P',
            '-m',
            'my_robot_basics.ros2.shell',
            '-c',
            f'cd "$ROS_WS"\n{script}',
        ],
        env={**os.environ, **environment},
        capture_output=True,
        encoding='utf-8',
        timeout=TIMEOUT_SEC,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


# --- what is made and kept -----------------------------------------------------------------------


def test_the_default_workspace_is_in_the_course_and_ignored_by_git(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_WORKSPACE')
    assert classroom.workspace() == ROOT / 'ros_ws'
    ignored = subprocess.run(['git', 'check-ignore', '-q', 'ros_ws/'], cwd=ROOT)
    assert ignored.returncode == 0


def test_a_new_workspace_holds_the_package_and_reference_files_to_copy_from(folder, capsys):
    assert workspace.main([]) is None
    package = folder / 'src/my_robot_basics'
    modules = {path.name for path in package.glob('my_robot_basics/*.py')}
    assert {'__init__.py', 'kinematics_publisher.py', 'kinematics_subscriber.py'} < modules
    assert modules == {
        path.name for path in (ROOT / 'my_robot_basics/my_robot_basics').glob('*.py')
    }
    assert not [path for path in (package / 'my_robot_basics').iterdir() if path.is_dir()]
    assert (package / 'resource/my_robot_basics').is_file()
    reference = folder / 'reference/src/my_robot_basics'
    files = {str(path.relative_to(reference)) for path in reference.rglob('*') if path.is_file()}
    nodes = {f'my_robot_basics/kinematics_{name}.py' for name in ('publisher', 'subscriber')}
    assert files == {'setup.py'} | nodes
    for name in files:
        assert (reference / name).read_bytes() == (ROOT / 'my_robot_basics' / name).read_bytes()
    said = capsys.readouterr().out
    assert said.startswith(f'ROS_WS is {folder}\nmade     $ROS_WS/src/my_robot_basics: ')
    assert workspace.BUILD in said


def test_files_that_a_student_changed_are_kept_and_listed(package, capsys, monkeypatch):
    (package / 'setup.py').write_text('mine')
    (package / 'my_robot_basics/my_node.py').write_text('mine, too')
    (package / 'my_robot_basics/hello_node.py').unlink()
    (package / 'my_robot_basics/__pycache__').mkdir()
    (package / 'my_robot_basics/__pycache__/x.pyc').touch()
    capsys.readouterr()
    make_workspace()
    said = capsys.readouterr().out
    assert (package / 'setup.py').read_text() == 'mine'
    assert not (package / 'my_robot_basics/hello_node.py').exists()
    lines = [line.split() for line in said.splitlines()]
    assert [line for line in lines if line[0] in ('new', 'changed', 'missing')] == [
        ['missing', 'my_robot_basics/hello_node.py'],
        ['new', 'my_robot_basics/my_node.py'],
        ['changed', 'setup.py'],
    ]
    assert './course workspace --refresh' in said
    monkeypatch.delenv('JPY_SESSION_NAME', raising=False)
    monkeypatch.setenv(OF_TERMINALS, 'zh_CN')
    make_workspace()
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [line[0] for line in lines if line[1:] == ['setup.py']] == ['已改']
    assert {line[0] for line in lines if line[1].startswith('my_robot_basics/')} == {
        '新增',
        '缺少',
    }


def test_an_unedited_workspace_is_reported_as_unchanged(package, capsys):
    make_workspace()
    assert 'the package, unchanged' in capsys.readouterr().out
    make_workspace(refresh=True)
    assert not (package.parents[1] / 'kept').exists()


def test_refresh_makes_a_new_copy_and_keeps_the_former_one(folder, package, capsys):
    for number in (1, 2):
        (package / 'setup.py').write_text(f'mine {number}')
        make_workspace(refresh=True)
        kept = folder / f'kept/my_robot_basics_{number}'
        assert (kept / 'setup.py').read_text() == f'mine {number}'
        assert f'$ROS_WS/kept/{kept.name}: ' in capsys.readouterr().out
        assert (package / 'setup.py').read_text().startswith('"""Builds the package')


def test_a_copy_that_was_cut_short_is_made_again(folder, capsys):
    (folder / 'src/.my_robot_basics.part/left').mkdir(parents=True)
    make_workspace()
    assert not (folder / 'src/.my_robot_basics.part').exists()
    assert not (folder / 'src/my_robot_basics/left').exists()


@pytest.mark.skipif(os.geteuid() == 0, reason='root may write anywhere')
def test_a_workspace_that_cannot_be_written_is_reported_in_one_line(folder):
    folder.mkdir(mode=0o500)
    assert workspace.main([]).startswith('course: [Errno 13] Permission denied')


def test_a_missing_package_is_reported_with_the_command_to_use(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(workspace, 'PACKAGE', tmp_path)
    assert workspace.main([]).endswith('start the notebook with ./course lab')


def test_the_command_workspace_has_the_option_refresh(package, capsys):
    (package / 'setup.py').write_text('mine')
    assert workspace.main([]) is None
    assert workspace.main(['--refresh']) is None
    assert 'moved ' in capsys.readouterr().out


def test_the_workspace_of_the_course_is_linked_into_the_file_browser(tmp_path, monkeypatch):
    monkeypatch.setattr(workspace, 'LESSONS', tmp_path / 'notebooks')
    link = tmp_path / 'notebooks/ros_ws'
    link.parent.mkdir()
    for elsewhere in ('another place', 'another place/ros_ws'):
        monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path / elsewhere))
        make_workspace()
        assert not link.is_symlink()
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path / 'ros_ws'))
    for _ in range(2):
        make_workspace()
        assert link.readlink() == Path('../ros_ws')
        assert (link / 'src/my_robot_basics/setup.py').is_file()
    edition = tmp_path / 'notebooks/zh_CN'
    edition.mkdir()
    (edition / 'index.ipynb').touch()
    make_workspace()
    assert (edition / 'ros_ws').readlink() == Path('../../ros_ws')
    link.unlink()
    link.mkdir()
    make_workspace()
    assert not link.is_symlink()


def test_the_link_to_the_workspace_is_ignored_by_git():
    ignored = subprocess.run(['git', 'check-ignore', '-q', 'notebooks/ros_ws'], cwd=ROOT)
    assert ignored.returncode == 0


# --- what a terminal does in it ------------------------------------------------------------------


@pytest.fixture(scope='module')
def first_build(tmp_path_factory):
    """A workspace that was built, to be read only, and the output of the build."""
    folder = tmp_path_factory.mktemp('built') / 'ros ws'
    # set, this variable lets setuptools warn
    build = 'env -u PYTHONDONTWRITEBYTECODE colcon build --packages-select my_robot_basics'
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(folder))
        make_workspace()
        said = shell(f'{build} >log.txt 2>&1; cat log.txt')
    return folder, said


@pytest.fixture
def built(first_build, monkeypatch):
    """The student's copy, built; the tests of a workspace share it, and change nothing."""
    folder, _ = first_build
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(folder))
    return folder / 'src/my_robot_basics'


@pytest.mark.slow
@pytest.mark.starts
def test_a_build_prints_the_usual_output_of_colcon(first_build):
    _, said = first_build
    seconds = r'\[[\d.]+s\]'
    assert re.search(
        rf'^Starting >>> my_robot_basics\nFinished <<< my_robot_basics {seconds}\n\n'
        rf'Summary: 1 package finished {seconds}\n*\Z',
        said,
        re.MULTILINE,
    )


@pytest.mark.starts
def test_nodes_built_in_the_workspace_are_those_that_run(built):
    installed = built.parents[1] / 'install/my_robot_basics'
    nodes = ['hello_node', 'kinematics_node', 'kinematics_publisher', 'kinematics_subscriber']
    assert shell(f'{SOURCE} ros2 pkg executables my_robot_basics --full-path').split('\n') == [
        *(f'{installed}/lib/my_robot_basics/{name}' for name in nodes),
        '',
    ]
    with own_domain():
        said = shell(SOURCE + ros2_run('kinematics_publisher', until='published'))
    assert '[kinematics_publisher]: published' in said
    # before it is sourced, the package of the virtual environment is found
    assert shell('ros2 pkg prefix my_robot_basics') == f'{sys.prefix}\n'
    assert shell(f'{SOURCE} ros2 pkg prefix my_robot_basics') == f'{installed}\n'
    assert shell(f'{SOURCE} ros2 pkg prefix rclpy') == f'{sys.prefix}\n'


NODE = """
import rclpy
from rclpy.node import Node


class MyNode(Node):
    def __init__(self):
        super().__init__('my_node')
        self.get_logger().info('I am new')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(MyNode())
"""


@pytest.mark.slow
@pytest.mark.starts
def test_a_node_added_to_setup_py_can_be_run_after_the_next_build(package):
    shell(BUILD)
    run = SOURCE + ros2_run('my_node', until='new')
    (package / 'my_robot_basics/my_node.py').write_text(textwrap.dedent(NODE))
    setup = (package / 'setup.py').read_text()
    line = "            'hello_node = my_robot_basics.hello_node:main',\n"
    assert line in setup
    (package / 'setup.py').write_text(setup.replace(line, line + line.replace('hello', 'my')))
    assert shell(run) == 'No executable found\n'
    assert '[my_node]: I am new' in shell(BUILD + run)


@pytest.mark.slow
@pytest.mark.starts
def test_the_ros2_tools_do_not_use_the_students_copy_of_the_package(package):
    for name in ('__init__', 'two_link_kinematics'):
        (package / f'my_robot_basics/{name}.py').write_text('raise SystemExit("the copy")\n')
    said = shell(
        f'{BUILD} {SOURCE} python -c "import my_robot_basics" 2>&1;'
        'ros2 pkg list | grep my_; topic_doctor --help | head -1'
    )
    assert said.startswith('the copy\nmy_robot_basics\nusage: topic_doctor')


@pytest.mark.starts
def test_a_terminal_needs_nothing_but_the_sourced_workspace(built):
    bare = {'PATH': '/usr/bin:/bin', 'HOME': str(built), 'ROS_LOG_DIR': str(built / 'log')}
    if ' ' in sys.executable:
        # colcon's setup.bash stumbles over it, and the terminals of the course set this
        bare['COLCON_PYTHON_EXECUTABLE'] = str(Path(sys.executable).resolve())
    script = f'{SOURCE} {SOURCE} ros2 pkg prefix my_robot_basics; ros2 pkg prefix rclpy'
    done = subprocess.run(
        ['bash', '-c', script],
        cwd=built.parents[1],
        env=bare,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_SEC,
    )
    install = built.parents[1] / 'install/my_robot_basics'
    assert (done.stdout, done.stderr) == (f'{install}\n{sys.prefix}\n', '')


@pytest.mark.slow
@pytest.mark.starts
def test_a_cell_builds_and_runs_the_workspace_but_the_kernel_keeps_its_package(folder):
    cells = [
        'from my_robot_basics.live import make_workspace\nmake_workspace()',
        f'%%bash\ncd "$ROS_WS"\n{BUILD}{SOURCE}'
        + ros2_run('kinematics_publisher', until='publishing'),
        'import my_robot_basics; print(my_robot_basics.__file__)',
    ]
    manager, client = start_new_kernel(env=dict(os.environ))
    printed = []
    try:
        for cell in cells:
            client.execute_interactive(
                cell,
                timeout=TIMEOUT_SEC,
                output_hook=lambda message: printed.append(
                    message['content'].get('text', message['msg_type'])
                ),
            )
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
    said = ''.join(text for text in printed if text not in ('status', 'execute_input'))
    assert 'publishing a random pose' in said
    assert said.endswith(f'{ROOT}/my_robot_basics/my_robot_basics/__init__.py\n')


def test_the_help_of_the_command_workspace_is_written_for_students(capsys):
    with pytest.raises(SystemExit):
        workspace.main(['--help'])
    said = ' '.join(capsys.readouterr().out.split())
    assert 'Make ros_ws/, a colcon workspace with a copy of the packages' in said
    assert 'Raises' not in said
