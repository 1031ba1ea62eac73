"""A node on the graph whose program has ended: whether the program is to blame."""

import signal
from types import SimpleNamespace

import pytest
from my_robot_basics.checks.packages import package_processes, spinning
from my_robot_basics.checks.packages.package_processes import GONE_SEC, RunningExecutable
from my_robot_basics.feedback.errors import CheckFailed, Starved


@pytest.mark.parametrize(
    ('answers', 'free_sec', 'doubt'),
    [(True, GONE_SEC, CheckFailed), (False, GONE_SEC, Starved), (True, 1.0, Starved)],
    ids=['it lives', 'nobody answers', 'the machine is busy'],
)
def test_a_node_left_on_the_graph_is_blamed_on_its_program_only_if_it_answers(
    monkeypatch, answers, free_sec, doubt
):
    watch = SimpleNamespace(free_sec=lambda: free_sec)
    monkeypatch.setattr(package_processes, 'Stopwatch', lambda: watch)
    monkeypatch.setattr(package_processes, 'answers_parameters', lambda *_: answers)
    program = RunningExecutable('greeter', 'greet', ())
    program._nodes = ['/greeter']
    program._watcher = SimpleNamespace(spin_until_free=lambda is_gone, free_sec: False)
    with pytest.raises(CheckFailed, match='/greeter to be gone from the graph') as raised:
        program._expect_gone()
    assert raised.type is doubt


@pytest.mark.parametrize(
    ('code', 'words'),
    [
        (-signal.SIGSEGV, 'ended by SIGSEGV: rclpy crashes like this if an ActionClient or Act'),
        (-signal.SIGABRT, "ended by SIGABRT: run it with run_executable('greeter', 'greet')"),
        (-signal.SIGKILL, "ended by SIGKILL: run it with run_executable('greeter', 'greet')"),
        (1, "exit code 1: run it with run_executable('greeter', 'greet')"),
        (0, 'exit code 0: main has returned: let it spin the node until Ctrl-C'),
    ],
)
def test_a_program_that_ended_gets_advice_for_its_exit_code(monkeypatch, code, words):
    program = RunningExecutable('greeter', 'greet', ())
    monkeypatch.setattr(program, '_state', lambda: (code, ''))
    with pytest.raises(CheckFailed) as raised:
        program._fail_ended('the node /greeter of greet')
    assert f'saw it has ended: {words}' in str(raised.value)


@pytest.mark.parametrize(
    ('end', 'code', 'hint'),
    [
        ('expect_end', -signal.SIGSEGV, 'rclpy crashes like this if an ActionClient'),
        ('expect_end', 1, 'let main return without an exception'),
        ('expect_clean_end', -signal.SIGSEGV, 'rclpy can crash like this if main returns'),
        ('expect_clean_end', -signal.SIGABRT, 'rclpy can crash like this if main returns'),
        ('expect_clean_end', 2, 'no exception ended it, so main returns something'),
    ],
)
def test_a_bad_exit_code_fails_with_its_likely_cause(monkeypatch, end, code, hint):
    program = RunningExecutable('greeter', 'greet', ())
    monkeypatch.setattr(program, '_state', lambda: (code, ''))
    for name in ('expect_running', '_ask', '_wait_for_end'):
        monkeypatch.setattr(program, name, lambda *_, **__: None)
    monkeypatch.setattr(program, '_watcher', None, raising=False)
    monkeypatch.setattr(spinning, 'wait_until_they_spin', lambda *_: None)
    with pytest.raises(CheckFailed, match=f': {hint}'):
        getattr(program, end)()


@pytest.mark.parametrize(
    ('told', 'hint'),
    [
        ({'own': True}, 'leave SIGINT to rclpy.init'),
        ({'own': False}, 'let no callback and no loop go on for long'),
        ({}, 'let no callback and no loop go on for long'),
    ],
    ids=['own handler', 'none', 'no answer'],
)
def test_a_program_that_goes_on_gets_advice_about_its_own_handler(monkeypatch, told, hint):
    program = RunningExecutable('greeter', 'greet', ())
    monkeypatch.setattr(program, '_ask', lambda verb: told if verb == 'handlers' else {})
    watcher = SimpleNamespace(spin_until_free=lambda has_ended, free_sec: False)
    monkeypatch.setattr(program, '_watcher', watcher, raising=False)
    with pytest.raises(CheckFailed, match=f'it still runs after 5 s: {hint}'):
        program._wait_for_end('greet to end after SIGINT', package_processes.END_SEC)
