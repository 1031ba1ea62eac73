"""A package beside the notebook: it is built by colcon and run, and its faults are reported."""

import os
import signal
import sys
import time
from pathlib import Path

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks import package as package_of
from my_robot_basics.live.packages import executables, package_build, packages
from my_robot_basics.session.errors import NotRunnable
from package_maker import PACKAGE, make_package

from my_robot_basics import live

PATIENCE_SEC = 60.0


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The notebook's folder, with a workspace of its own; nothing is left running."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'ros_ws').mkdir()
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path / 'ros_ws'))
    monkeypatch.setattr(packages, '_builds', {})
    yield tmp_path
    live.stop()


def printed(capsys):
    return ' '.join(capsys.readouterr().out.split())


def until(done):
    deadline = time.monotonic() + PATIENCE_SEC
    while not done() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert done()


def tree(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob('*')}


# --- made ----------------------------------------------------------------------------------------


def test_a_package_skeleton_is_made_once(folder, capsys):
    live.make_package(PACKAGE, node_name='greet', dependencies=['rclpy'])
    assert printed(capsys).startswith('made greeter/ beside the notebook: package.xml setup.py')
    assert '<depend>rclpy</depend>' in (folder / PACKAGE / 'package.xml').read_text()
    (folder / PACKAGE / 'setup.py').write_text('mine')
    with pytest.raises(NotRunnable, match=r'expected no folder greeter/ beside the notebook'):
        live.make_package(PACKAGE)
    assert (folder / PACKAGE / 'setup.py').read_text() == 'mine'


@pytest.mark.parametrize('name', ['../x', 'Greeter', '9', 'a-b', ''])
def test_an_invalid_package_name_is_refused(name):
    for do in live.make_package, live.build_package:
        with pytest.raises(NotRunnable, match='expected the name of a package'):
            do(name)


# --- built ---------------------------------------------------------------------------------------

WRONG = {
    'no manifest': ({'package.xml': None}, 'has no package.xml, so it is no ROS package yet'),
    'a folder too deep': (
        {'package.xml': None, 'greeter/package.xml': '<package/>'},
        'package.xml is in greeter/greeter/, and has to be in greeter/: move all that is in',
    ),
    'a broken manifest': ({'package.xml': '<package'}, 'greeter/package.xml is not valid'),
    'another name': (
        {'package.xml': lambda text: text.replace('<name>greeter', '<name>greeting')},
        "package.xml names the package 'greeting', and its folder is greeter/",
    ),
    'another build type': (
        {'package.xml': lambda text: text.replace('ament_python', 'ament_cmake')},
        'has the build type ament_cmake, expected ament_python',
    ),
    'no build type': (
        {
            'package.xml': lambda text: text.replace('<build_type>ament_python</build_type>', ''),
        },
        'package.xml has no build type: write <export><build_type>ament_python</build_type>',
    ),
    'no setup.py': ({'setup.py': None}, 'has no setup.py, which tells colcon'),
    'a slip in setup.py': ({'setup.py': 'setup(\n  x\n'}, 'line 1 of greeter/setup.py is not'),
}


def changed(folder, changes):
    for name, change in changes.items():
        path = folder / name
        if change is None:
            path.unlink()
        else:
            path.write_text(change if isinstance(change, str) else change(path.read_text()))


@pytest.mark.parametrize(('changes', 'words'), WRONG.values(), ids=list(WRONG))
def test_a_fault_of_a_package_is_reported_and_nothing_is_built(folder, capsys, changes, words):
    changed(make_package(folder), changes)
    live.build_package(PACKAGE)
    assert words in printed(capsys)
    assert not (folder / 'ros_ws' / 'install').exists()


def test_a_missing_package_folder_is_reported(capsys):
    live.build_package(PACKAGE)
    assert printed(capsys).startswith('there is no folder greeter/ beside this notebook: make it')


@pytest.mark.starts
def test_a_package_is_built_run_and_ended(folder, capsys):
    """One build of a correct package, and everything that can be done with the result."""
    make_package(folder, build__x='not mine', **{'greeter/more.py': 'import sensor_msgs.msg'})
    before = tree(folder / PACKAGE)
    live.build_package(PACKAGE)
    assert printed(capsys) == (
        'built greeter in $ROS_WS/install/greeter: `ros2 run greeter` finds greet not handed in, '
        'and not built: build (made by a build, which is done again at grading) '
        'package.xml does not name sensor_msgs, which greeter/more.py imports: on a robot, colcon '
        'and rosdep would not know that it is needed; add <depend>sensor_msgs</depend>'
    )
    assert tree(folder / PACKAGE) == before

    package = package_of(PACKAGE)
    package.expect_built(executables=('greet',))
    with pytest.raises(CheckFailed, match='expected the executables greet, other in greeter, saw'):
        package.expect_built(executables=('greet', 'other'))

    live.run_executable(PACKAGE, 'greet')
    [by_notebook] = executables._started.values()
    until(lambda: by_notebook.process.lines)
    with package.run('greet', parameters={'words': 'ho'}, rules={'__ns': '/x'}) as greeter:
        assert by_notebook.process.code is not None
        greeter.expect_node('/x/greeter')
        greeter.expect_running()
        with pytest.raises(CheckFailed, match='expected greet to end by itself, saw it still'):
            greeter.expect_end(within_sec=0.1)
        greeter.expect_clean_end()
        with pytest.raises(CheckFailed, match='expected greet to go on running, saw it has ended'):
            greeter.expect_running()
    capsys.readouterr()
    assert not live.run_executable(PACKAGE, 'other')
    said = 'not started: expected an executable other in greeter, saw greet'
    assert said in printed(capsys)
    with (
        pytest.raises(CheckFailed, match='expected other of greeter to start, saw no process'),
        package.run('other'),
    ):
        pass
    assert live.run_executable(PACKAGE, 'greet')
    until(lambda: executables._started and [*executables._started.values()][-1].process.lines)
    live.stop()
    assert 'greet: ended cleanly after SIGINT' in printed(capsys)


UNCLEAN = """
import signal, sys, time
def main():
    signal.signal(signal.SIGINT, {handler})
    print('up', flush=True)
    time.sleep(600)
"""


@pytest.mark.starts
@pytest.mark.parametrize(
    ('handler', 'words', 'check'),
    [
        ('signal.SIG_IGN', 'did not end after SIGINT: it took SIGTERM', 'it still runs after'),
        ('lambda *_: sys.exit(3)', 'not cleanly (exit code 3)', 'exit code 3, up'),
        ('lambda *_: 1 / 0', 'with ZeroDivisionError', 'exit code 1, ZeroDivisionError: div'),
    ],
)
def test_an_unclean_end_of_an_executable_is_reported(
    folder, capsys, monkeypatch, handler, words, check
):
    monkeypatch.setattr('my_robot_basics.live.packages.processes.END_SEC', 1.0)
    monkeypatch.setattr('my_robot_basics.checks.packages.package_processes.END_SEC', 1.0)
    script = folder / 'ros_ws/install/greeter/lib/greeter/greet'
    script.parent.mkdir(parents=True)
    script.write_text(f'#!/usr/bin/env python3\n{UNCLEAN.format(handler=handler)}\nmain()\n')
    script.chmod(0o755)
    live.run_executable(PACKAGE, 'greet')
    [one] = executables._started.values()
    until(lambda: 'up' in one.process.lines)
    live.stop()
    assert words in printed(capsys)
    with package_of(PACKAGE).run('greet') as greeter:
        [one] = executables._started.values()
        until(lambda: 'up' in one.process.lines)
        with pytest.raises(CheckFailed, match=check):
            greeter.expect_clean_end()


NODE_IN_A_CHILD = """
import os, signal, sys, time
child = os.fork()
if child:
    signal.signal(signal.SIGINT, lambda *_: sys.exit(0))
    time.sleep(600)
os.setsid()
import rclpy
from rclpy.node import Node
rclpy.init()
print(os.getpid(), flush=True)
rclpy.spin(Node('greeter'))
"""


@pytest.mark.starts
def test_a_node_that_outlives_its_executable_is_reported(folder, monkeypatch):
    monkeypatch.setattr('my_robot_basics.checks.packages.package_processes.GONE_SEC', 1.0)
    script = folder / 'ros_ws/install/greeter/lib/greeter/greet'
    script.parent.mkdir(parents=True)
    script.write_text(f'#!{sys.executable}\n{NODE_IN_A_CHILD}')
    script.chmod(0o755)
    with package_of(PACKAGE).run('greet') as greeter:
        greeter.expect_node('/greeter')
        [one] = executables._started.values()
        until(lambda: one.process.lines)
        try:
            with pytest.raises(CheckFailed, match='expected /greeter to be gone from the graph'):
                greeter.expect_clean_end()
        finally:
            os.kill(int(one.process.lines[0]), signal.SIGKILL)


@pytest.mark.starts
def test_an_executable_that_leaves_its_process_group_is_ended(folder, monkeypatch):
    monkeypatch.setattr('my_robot_basics.live.packages.processes.END_SEC', 1.0)
    script = folder / 'ros_ws/install/greeter/lib/greeter/greet'
    script.parent.mkdir(parents=True)
    leave = "import os, time\nos.setpgid(0, os.getpgid(os.getppid()))\nprint('up', flush=True)\n"
    script.write_text(f'#!/usr/bin/env python3\n{leave}time.sleep(600)\n')
    script.chmod(0o755)
    live.run_executable(PACKAGE, 'greet')
    [one] = executables._started.values()
    until(lambda: 'up' in one.process.lines)
    live.stop()
    assert one.process.code is not None


@pytest.mark.slow
@pytest.mark.starts
def test_the_error_of_an_executable_that_ends_at_once_is_reported(folder, capsys):
    make_package(folder, node='def main():\n    import no_such_module\n')
    live.build_package(PACKAGE)
    live.run_executable(PACKAGE, 'greet')
    until(lambda: next(iter(executables._started.values())).process.code is not None)
    live.stop()
    words = "No module named 'no_such_module'"
    assert words in printed(capsys)
    with (
        pytest.raises(CheckFailed, match=f'it has ended: exit code 1, ModuleNotFound.*{words}'),
        package_of(PACKAGE).run('greet') as greeter,
    ):
        greeter.expect_node('/greeter')


@pytest.mark.starts
@pytest.mark.parametrize(
    ('changes', 'words'),
    [
        ({'resource/greeter': None}, 'setup.py installs resource/greeter, and there is no such'),
        pytest.param(
            {'setup.cfg': None},
            'are in bin/, where `ros2 run` does not look: write into setup.cfg',
            marks=pytest.mark.slow,
        ),
        pytest.param(
            {'setup.py': lambda text: text.replace('greeter.greet:', 'greeter.grete:')},
            'and there is no greeter/grete.py: write that module, or correct the name',
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_failed_or_incomplete_build_is_reported_with_a_remedy(folder, capsys, changes, words):
    changed(make_package(folder), changes)
    live.build_package(PACKAGE)
    assert words in printed(capsys)
    with pytest.raises(CheckFailed, match='expected greeter to be built'):
        package_of(PACKAGE).expect_built()


@pytest.mark.starts
def test_an_executable_that_a_failed_build_lacks_is_not_started_for_the_same_reason(
    folder, capsys
):
    changed(make_package(folder), {'resource/greeter': None})
    live.build_package(PACKAGE)
    printed(capsys)
    assert not live.run_executable(PACKAGE, 'greet')
    assert 'not started: setup.py installs resource/greeter' in printed(capsys)
    with (
        pytest.raises(CheckFailed, match=r'saw no process: .* installs resource/greeter'),
        package_of(PACKAGE).run('greet'),
    ):
        pass


@pytest.mark.starts
def test_an_interrupt_ends_a_build_and_the_processes_that_it_started(folder, monkeypatch):
    sleeper = 'import os, time\nopen("{}", "w").write(str(os.getpid()))\ntime.sleep(600)\n'
    pid = folder / 'pid'
    make_package(folder, **{'setup.py': sleeper.format(pid)})

    def interrupted(colcon):
        until(lambda: pid.exists() and pid.read_text())
        raise KeyboardInterrupt

    monkeypatch.setattr(package_build, '_end_of', interrupted)
    with pytest.raises(KeyboardInterrupt):
        live.build_package(PACKAGE)
    until(lambda: not Path('/proc', pid.read_text()).exists())


LEFT_RUNNING = {
    'as it is': 'time.sleep(600)',
    'without an environment': 'os.execve("/bin/sleep", ["sleep", "600"], {})',
    'by a child that has ended': 'os.fork() and os._exit(0); note(); time.sleep(600)',
    'by no signal but one': (
        'import signal\n'
        '    signals = signal.valid_signals() - {signal.SIGKILL, signal.SIGSTOP}\n'
        '    for each in signals: signal.signal(each, signal.SIG_IGN)\n'
        '    os.environ.clear(); time.sleep(600)'
    ),
}


@pytest.mark.slow
@pytest.mark.starts
@pytest.mark.timeout(300)
@pytest.mark.parametrize('what', LEFT_RUNNING.values(), ids=LEFT_RUNNING)
def test_a_process_that_setup_py_leaves_running_does_not_hold_up_a_build(folder, capsys, what):
    """A child in a session of its own, with colcon's pipe."""
    leaves = (
        'import os, time\n'
        'def note(): open("{0}", "w").write(str(os.getpid()))\n'
        'if not os.path.exists("{0}") and os.fork() == 0:\n'
        '    os.setsid()\n'
        '    note()\n'
        f'    {what.replace("{", "{{").replace("}", "}}")}\n'
        'from setuptools import setup\n'
        'setup(name="greeter", version="0.1.0", packages=["greeter"])\n'
    )
    pid = folder / 'pid'
    make_package(folder, **{'setup.py': leaves.format(pid)})
    live.build_package(PACKAGE)
    assert 'greeter was built, and has no executable' in capsys.readouterr().out
    until(lambda: not Path('/proc', pid.read_text()).exists())


@pytest.mark.starts
def test_a_check_is_answered_if_nothing_was_built_or_started(folder):
    with pytest.raises(CheckFailed, match='expected greeter to be built, saw no build: run the'):
        package_of(PACKAGE).expect_built()
    told = packages.answer_check(PACKAGE, 'state', 99)
    assert told == {'problem': 'nothing was started under that number'}
