"""Faults of a package, described in words: of its build, its installation and its end."""

import signal
import sys
import types

import pytest
from my_robot_basics.checks.packages import package_words
from my_robot_basics.exchange.endings import RACE, is_clean, why_crashed
from my_robot_basics.live.packages import executables
from my_robot_basics.live.packages.install_faults import fault_in_install
from my_robot_basics.live.packages.package_faults import fault_in_words
from my_robot_basics.live.packages.package_signals import handles_ctrl_c, waits_in_call
from my_robot_basics.session import package_files
from package_maker import NODE, PACKAGE, make_package


def ended(code, *lines):
    process = types.SimpleNamespace(
        code=code, lines=['Traceback (most recent call last):', *lines]
    )
    return executables.how_it_ended(types.SimpleNamespace(process=process), signal.SIGINT)


def test_an_end_by_a_race_of_rclpy_is_reported_as_clean():
    assert ended(1, f'rclpy._rclpy_pybind11.RCLError: {RACE}') == ended(0)
    assert 'not cleanly (exit code 1, with KeyboardInterrupt)' in ended(1, 'KeyboardInterrupt')


def test_a_crash_in_a_notebook_is_reported_with_the_same_cause_as_in_feedback():
    process = types.SimpleNamespace(code=-signal.SIGSEGV, lines=[])
    said = executables.how_it_ended(types.SimpleNamespace(process=process), None)
    assert said == f'had ended by itself (by SIGSEGV): {why_crashed(-signal.SIGSEGV)}'
    process.code = -signal.SIGRTMIN - 1  # it has no name
    said = executables.how_it_ended(types.SimpleNamespace(process=process), None)
    assert said == f'had ended by itself (by signal {signal.SIGRTMIN + 1})'


def test_an_exception_in_a_notebook_is_reported_with_the_same_hint_as_in_feedback():
    raised = (
        "rclpy.exceptions.InvalidParameterTypeException: Trying to set parameter 'targets' to "
    )
    raised += "'[1.2]' of type 'DOUBLE_ARRAY', expecting type 'BYTE_ARRAY': targets"
    process = types.SimpleNamespace(code=1, lines=['Traceback (most recent call last):', raised])
    said = executables.how_it_ended(types.SimpleNamespace(process=process), None)
    assert said.startswith(f'had ended by itself (exit code 1): {raised}, so declare it with')


@pytest.mark.parametrize('by', [signal.SIGSEGV, signal.SIGABRT])
def test_a_crash_after_ctrl_c_is_attributed_to_a_thread_that_still_spins(by):
    process = types.SimpleNamespace(code=-by, lines=[])
    said = executables.how_it_ended(types.SimpleNamespace(process=process), signal.SIGINT)
    assert 'if main returns while a thread still spins' in said
    assert 'a type that is not an action' not in said


def test_a_second_race_of_rclpy_is_clean_only_with_try_shutdown():
    first, last = 'Traceback (most recent call last):', f'rclpy._rclpy_pybind11.RCLError: {RACE}'
    once_too_often = [first, '    rclpy.shutdown()', last]
    assert is_clean(1, once_too_often)
    assert not is_clean(1, once_too_often, is_second=True)
    assert is_clean(1, [first, '    rclpy.try_shutdown()', last], is_second=True)


def test_the_warning_about_a_main_that_nobody_awaits_is_shown():
    said = (
        "<coroutine>\nsys:1: RuntimeWarning: coroutine 'main' was never awaited\n"
        'RuntimeWarning: Enable tracemalloc to get the object allocation traceback'
    )
    shown = package_words.describe_end(1, said)
    assert "exit code 1, sys:1: RuntimeWarning: coroutine 'main' was never awaited, so" in shown


@pytest.mark.parametrize(
    ('error', 'advice'),
    [
        ("AttributeError: 'NoneType' object has no attribute 'reachable'", 'correct this error'),
        ("NameError: name 'ExternalShutdownException' is not defined", 'correct this error first'),
        ('KeyboardInterrupt', 'in main, catch KeyboardInterrupt'),
        ('rclpy.executors.ExternalShutdownException', 'in main, catch KeyboardInterrupt'),
        (f'rclpy._rclpy_pybind11.RCLError: failed to shutdown: {RACE}', 'call rclpy.try_shutdown'),
    ],
)
def test_only_an_interrupt_is_to_be_caught_for_a_clean_end(error, advice):
    said = f'Traceback (most recent call last):\n  File "x", line 1, in main\n{error}'
    assert advice in package_words.why_not_clean(1, said)


def test_arguments_that_argparse_does_not_know_are_explained():
    said = 'usage: arm_player [-h]\narm_player: error: unrecognized arguments: --ros-args -p a:=1'
    assert 'a:=1, so write parse_known_args() for' in package_words.describe_end(2, said)


def test_an_exit_code_without_an_exception_is_attributed_to_what_main_returns():
    process = types.SimpleNamespace(code=1, lines=['<arm_player.ArmPlayer object at 0x7f>'])
    said = executables.how_it_ended(types.SimpleNamespace(process=process), signal.SIGINT)
    advice = package_words.why_not_clean(1, process.lines[0])
    assert said == f'ended after SIGINT, but not cleanly (exit code 1): {advice}'
    assert 'return nothing, or 0' in advice
    cut = '  File "x", line 1, in main\nrclpy._rclpy_pybind11.RCLError: failed to shutdown'
    for said in cut, f'Traceback (most recent call last):\n{cut}':
        assert package_words.why_not_clean(1, said) == package_words.CLEANLY
    assert package_words.why_not_clean(-signal.SIGINT, '') == package_words.CLEANLY


def test_the_error_is_picked_from_the_output_of_colcon():
    words = (
        'Starting >>> greeter\n--- stderr: greeter\nTraceback (most recent call last):\n'
        '  File "<string>", line 1, in <module>\n'
        '  File "/x/ros_ws/.packages/greeter/setup.py", line 7, in <module>\n'
        "NameError: name 'nmae' is not defined\n---\nFailed   <<< greeter [0.5s, exited with 1]\n"
    )
    assert fault_in_words(PACKAGE, 1, words) == (
        "colcon does not build greeter: greeter/setup.py, line 7: NameError: name 'nmae' is not "
        'defined: fix that, and build again'
    )
    words = (
        'Traceback (most recent call last):\n  File "<string>", line 1, in <module>\n'
        '  File "/x/setuptools/_distutils/core.py", line 268, in run_setup\n    exec(code, g)\n'
        '  File "<string>", line 3, in <module>\n'
        "ModuleNotFoundError: No module named 'setuptool'\n"
        '--- stderr: greeter\nTraceback (most recent call last):\n'
        '  File "/x/colcon_core/executor/__init__.py", line 91, in __call__\n'
        "subprocess.CalledProcessError: Command '['python', '-c', 'import sys; …\n"
    )
    assert 'greeter: setup.py, line 3: ModuleNotFoundError: No' in fault_in_words(
        'greeter', 1, words
    )
    words = (
        "RuntimeError: 'distutils.core.setup()' was never called -- perhaps 'setup.py' is not\n"
    )
    assert 'without a comma between them: run `python3 setup.py --name` in greeter/' in (
        fault_in_words(PACKAGE, 1, words)
    )
    assert 'ended by SIGKILL' in fault_in_words(PACKAGE, -9, '')


def installed(tmp_path, entry):
    """An installed package with one entry point, as setuptools writes it."""
    prefix = tmp_path / 'prefix'
    site = next((prefix / 'lib').glob('python*/site-packages'), None)
    if site is None:
        site = prefix / 'lib/python{}.{}/site-packages'.format(*sys.version_info)
        marker = prefix / 'share/ament_index/resource_index/packages/greeter'
        for path in (site / 'greeter.egg-info/x', site / 'greeter/x', marker):
            path.parent.mkdir(parents=True, exist_ok=True)
        marker.touch()
        (prefix / 'lib/greeter').mkdir()
    (site / 'greeter.egg-info/entry_points.txt').write_text(f'[console_scripts]\n{entry}\n')
    return prefix, site


@pytest.mark.parametrize(
    ('entry', 'module', 'words'),
    [
        ('greet = greeter.greet:main', NODE, ''),
        ('greet = greeter.greet:mian', NODE, 'has no function mian: write main in its place'),
        ('greet = greeter.greet:Main', NODE, 'has no function Main: write main in its place'),
        ('greet = greeter.greet:MAIN', NODE, 'has no function MAIN: write main in its place'),
        ('greet = greeter.greet:go', NODE, 'has no function go: write `def go(args=None):` there'),
        ('greet = greeter.greet', NODE, 'names no function: write a colon and the function'),
        ('greet = greeter.greet.main', NODE, 'after the module, greeter.MODULE:main'),
        ('greet = greeter.greet:main', 'def main(:', 'greeter/greet.py is not valid Python (line'),
        ('greet = greeter.greet:main', None, 'greeter/greet.py was not installed, and greet'),
        ('greet = grete.greet:main', NODE, 'and there is no package grete: correct it'),
        ('greet = greeter.greet.py:main', NODE, 'leave out .py'),
        ('greet = greet:main', NODE, 'is in the package greeter: write greeter.greet:main'),
        ('greet = a b c', NODE, 'has no executable: name one in entry_points'),
    ],
)
def test_a_faulty_entry_point_is_reported(tmp_path, entry, module, words):
    files = package_files.read(make_package(tmp_path))
    prefix, site = installed(tmp_path, entry)
    if module is not None:
        (site / 'greeter/greet.py').write_text(module)
    said = fault_in_install(PACKAGE, prefix, files)
    assert (words in said) if words else (said == '')


def test_a_module_without_a_package_may_be_an_executable(tmp_path):
    files = package_files.read(make_package(tmp_path))
    prefix, site = installed(tmp_path, 'greet = greet:main')
    (site / 'greet.py').write_text(NODE)
    assert fault_in_install(PACKAGE, prefix, files) == ''


def test_the_module_is_named_that_an_entry_point_left_out(tmp_path):
    folder = make_package(tmp_path)
    (folder / PACKAGE / 'greeter.py').write_text(NODE)
    files = package_files.read(folder)
    prefix, site = installed(tmp_path, 'greet = greeter:main')
    (site / 'greeter/__init__.py').touch()
    said = fault_in_install(PACKAGE, prefix, files)
    assert said.endswith('is in the package greeter: write greeter.greeter:main')


@pytest.mark.parametrize('name', ['bin', 'lib/other'])
def test_the_folder_in_which_the_executables_are_is_named(tmp_path, name):
    files = package_files.read(make_package(tmp_path))
    prefix, _ = installed(tmp_path, 'greet = greeter.greet:main')
    (prefix / 'lib/greeter').rmdir()
    (prefix / name).mkdir()
    said = fault_in_install(PACKAGE, prefix, files)
    assert f'the executables of greeter are in {name}/, where `ros2 run` does not look' in said


@pytest.mark.parametrize(
    ('line', 'words'),
    [
        ('#!python', "greet begins with '#!python', and there is no such program"),
        ('#!/nowhere/python3 -I', 'cannot start it: name a function in entry_points of setup.py'),
        ('#! /usr/bin/env python3', ''),
        (f'#!{sys.executable}', ''),
        ('#!', ''),
        ('x', ''),
    ],
)
def test_a_script_that_linux_cannot_start_is_named(tmp_path, line, words):
    files = package_files.read(make_package(tmp_path))
    prefix, site = installed(tmp_path, 'greet = greeter.greet:main')
    (site / 'greeter/greet.py').write_text(NODE)
    (prefix / 'lib/greeter/a_folder').mkdir()
    (prefix / 'lib/greeter/greet').write_text(f'{line}\nmain()\n')
    said = fault_in_install(PACKAGE, prefix, files)
    assert (words in said) if words else (said == '')


@pytest.mark.parametrize(
    ('is_in', 'line', 'expected'),
    [
        (handles_ctrl_c, 'signal.signal(signal.SIGINT, stop)', True),
        (handles_ctrl_c, 'signal(SIGINT, stop)', True),
        (handles_ctrl_c, 'rclpy.init(signal_handler_options=SignalHandlerOptions.NO)', True),
        (handles_ctrl_c, 'uninstall_signal_handlers()', True),
        (handles_ctrl_c, 'signal.signal(signal.SIGTERM, stop)', False),
        (handles_ctrl_c, 'rclpy.init(signal_handler_options=SignalHandlerOptions.ALL)', False),
        (handles_ctrl_c, 'pass  # Ctrl-C sends SIGINT', False),
        (waits_in_call, 'response = self.client.call(request)', True),
        (waits_in_call, 'future = self.client.call_async(request)', False),
        (waits_in_call, 'recall(request)', False),
    ],
)
def test_code_that_keeps_a_program_from_ending_is_found(tmp_path, is_in, line, expected):
    folder = make_package(tmp_path)
    (folder / 'greeter/more.py').write_text(f'{line}\n')
    assert is_in(folder) is expected
    assert not is_in(folder / 'nowhere')


HEAD = 'Traceback (most recent call last):'
IN_MAIN = '  File "/ws/arm_player/arm_driver.py", line 6, in main'
AN_IMPORT = '  File "<frozen importlib._bootstrap>", line 1176, in _find_and_load'
STARTING = [
    [],
    [HEAD, '  File "/ws/lib/arm_player/arm_driver", line 25', AN_IMPORT, 'KeyboardInterrupt'],
]
RUNNING = [
    ['Hi from arm_player.'],
    [HEAD, IN_MAIN, AN_IMPORT, 'KeyboardInterrupt'],
    [HEAD, IN_MAIN, 'KeyboardInterrupt'],
    [HEAD, AN_IMPORT, "ModuleNotFoundError: No module named 'rclpi'"],
]


@pytest.mark.parametrize('lines', [*STARTING, *RUNNING])
def test_a_program_that_was_stopped_before_its_code_ran_is_not_called_unclean(lines):
    process = types.SimpleNamespace(code=-signal.SIGINT, lines=lines)
    said = executables.how_it_ended(types.SimpleNamespace(process=process), signal.SIGINT)
    wanted = 'was stopped before it had started: to see how it ends, let it run for a few seconds'
    assert (said == wanted) == (lines in STARTING)
    assert ('not cleanly' in said) == (lines in RUNNING)
