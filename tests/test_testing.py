"""`./course test`: the commands that it runs, and how it treats tests that pass only alone."""

import os
import subprocess
import sys
from xml.sax.saxutils import quoteattr

import pytest

from launcher import testing
from launcher.environment import Environment
from launcher.testing import Checks
from launcher.unstable import (
    NO_KERNEL,
    add_unstable,
    count_causes,
    read_failures,
    read_passes,
    unstable,
)


def report(path, **cases):
    """Write what pytest writes: each case failed with these words, or passed."""
    bodies = {
        name: f'<failure message={quoteattr(why)}/>' if why else '' for name, why in cases.items()
    }
    rows = [f'<testcase classname="f" name="{n}">{body}</testcase>' for n, body in bodies.items()]
    path.write_text(f'<testsuites><testsuite>{"".join(rows)}</testsuite></testsuites>')
    return path


def test_a_test_that_failed_and_then_passed_is_unstable(tmp_path):
    failures = read_failures(report(tmp_path / '1', a='late\nby 2 s', b='wrong', c='late', d=''))
    assert failures == {'f::a': 'late by 2 s', 'f::b': 'wrong', 'f::c': 'late'}
    passes = read_passes(report(tmp_path / '2', a='', b='wrong'))
    assert unstable(failures, passes) == {'f::a': 'late by 2 s'}


def test_a_missing_report_holds_no_tests(tmp_path):
    assert read_failures(tmp_path / 'none') == {}
    assert read_passes(tmp_path / 'none') == set()


def test_the_record_counts_unstable_tests_of_all_runs(tmp_path):
    record = tmp_path / 'unstable_tests.txt'
    assert add_unstable(record, {'f::a': 'late'}) == 1
    assert add_unstable(record, {'f::a': 'late', 'f::b': 'late'}) == 3
    assert record.read_text().splitlines()[0].endswith('  f::a: late')


def test_all_cells_of_a_lesson_whose_kernel_did_not_start_have_one_cause():
    why = f'{NO_KERNEL} replying to kernel_info"'
    lesson = {f'solutions.08.ipynb::Cell {number}': why for number in range(26)}
    assert count_causes(lesson) == 1
    assert count_causes(lesson | {'solutions.09.ipynb::Cell 0': why}) == 2
    late = {f'solutions.10.ipynb::Cell {number}': 'late' for number in range(3)}
    assert count_causes(lesson | late) == 4
    assert count_causes({}) == 0


@pytest.mark.parametrize(
    ('number', 'why', 'status'),
    [(0, '', 0), (1, 'late', 0), (2, 'late', 0), (3, 'late', 1), (26, f'{NO_KERNEL} …"', 0)],
    ids=['none', 'one', 'two', 'three', 'no kernel'],
)
def test_more_than_two_unstable_tests_fail_a_run(number, why, status, tmp_path, capsys):
    names = [f't{each}' for each in range(number)]
    checks = Checks(Environment(tmp_path), {}, tmp_path)

    report(tmp_path / 'tests.xml', good='', **dict.fromkeys(names, why))

    def pass_alone():
        report(tmp_path / 'tests-alone.xml', **dict.fromkeys(names, ''))
        return ['true']

    assert checks.rerun('tests', 1, pass_alone) == status
    record = tmp_path / 'unstable_tests.txt'
    assert record.exists() == bool(number)
    if number:
        assert len(record.read_text().splitlines()) == number
        assert 'failed while others ran and passed alone' in capsys.readouterr().err


@pytest.mark.starts
@pytest.mark.parametrize(
    ('source', 'why'),
    [
        ('import nothing_like_this', "ModuleNotFoundError: No module named 'nothing_like_this'"),
        ('from os import nothing', "ImportError: cannot import name 'nothing' from 'os'"),
        ('def test_a(:', 'SyntaxError: invalid syntax'),
        ('1 / 0', 'ZeroDivisionError: division by zero'),
    ],
)
def test_a_file_that_cannot_be_imported_is_named_and_not_run_again(source, why, tmp_path, capsys):
    (tmp_path / 'test_broken.py').write_text(source)
    (tmp_path / 'test_good.py').write_text('def test_good(): pass')
    checks = Checks(Environment(tmp_path), {}, tmp_path)

    written = f'--junitxml={tmp_path / "tests.xml"}'
    command = [sys.executable, '-m', 'pytest', '-q', '-n', '1', written]
    status = subprocess.run(command, cwd=tmp_path, stdout=subprocess.DEVNULL).returncode
    alone = pytest.fail  # what cannot be imported is not run once more
    assert checks.rerun('tests', status, alone) == 1
    said = capsys.readouterr().err
    assert said.startswith('course: test_broken.py could not be imported, so none of its tests')
    assert f' were run: {why}' in said
    assert said.endswith('course: fix that, and run this again\n')
    assert 'beside others' not in said


@pytest.mark.starts
def test_a_wrong_pytest_argument_ends_the_run_at_once(tmp_path, monkeypatch):
    types = f'sleep 10; touch {tmp_path}/waited-for'
    for name, does in {'ruff': 'exit 0', 'mypy': types, 'python': 'exit 4'}.items():
        program = tmp_path / '.venv/bin' / name
        program.parent.mkdir(parents=True, exist_ok=True)
        program.write_text(f'#!/bin/sh\n{does}\n')
        program.chmod(0o755)
    assert testing.run(Environment(tmp_path), {'PATH': os.environ['PATH']}, ['--bogus']) == 4
    assert not (tmp_path / 'waited-for').exists()


@pytest.mark.starts
def test_the_option_help_prints_the_help_of_pytest_alone(tmp_path, capfd):
    python = tmp_path / '.venv/bin/python'
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho "$@"\n')
    python.chmod(0o755)  # there is no ruff, and none is called
    assert testing.run(Environment(tmp_path), {'PATH': os.environ['PATH']}, ['--help']) == 0
    assert capfd.readouterr().out == '-P -m pytest --help\n'


@pytest.mark.starts
@pytest.mark.parametrize(
    ('command', 'has_one'), [(('env',), True), (('false',), False), (('no-such-program',), False)]
)
def test_an_own_network_is_available_only_if_its_command_succeeds(monkeypatch, command, has_one):
    monkeypatch.setattr(testing, 'OWN_NETWORK', command)
    assert testing.has_own_network() == has_one


@pytest.mark.starts
@pytest.mark.isolation
def test_a_command_in_its_own_network_shares_no_network_and_no_memory():
    seen = subprocess.run(
        [*testing.OWN_NETWORK, 'sh', '-c', 'readlink /proc/self/ns/net; ls -A /dev/shm'],
        capture_output=True,
        text=True,
        check=True,
    )
    assert seen.stdout.strip() != os.readlink('/proc/self/ns/net')
    assert seen.stdout.count('\n') == 1  # shared memory of others is not there


def test_the_tests_of_a_fresh_clone_are_compiled_once(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(testing.subprocess, 'run', lambda command, **_: calls.append(command))
    checks = Checks(Environment(tmp_path), {}, tmp_path)
    checks.compile_tests()
    compiled = tmp_path / 'tests/__pycache__/test_a.cpython-311-pytest-9.2.0.pyc'
    compiled.parent.mkdir(parents=True)
    compiled.touch()
    checks.compile_tests()
    assert ['--collect-only' in command for command in calls] == [True]
