"""`ros2 run` and `ros2 pkg`: finding executables, passing arguments and signals, statuses."""

import os
import signal
import stat
import subprocess
import sys
import textwrap
import time

import pexpect
import pytest
from ros2_command import SCRIPT, TIMEOUT_SEC, ros2, started

EXECUTABLES = {
    'says': 'print(*sys.argv[1:])',
    'fails': 'sys.exit(3)',
    'dies': 'os.kill(os.getpid(), signal.SIGKILL)',
    'asks': 'print("hello", input())',
    'handles': 'print(signal.getsignal(signal.SIGINT).__name__)',
    # counts the signals that reach it; the second ends it
    'counts': """
        def count(number, frame):
            print(signal.Signals(number).name)
            end_at[0] = time.monotonic() + 0.7

        end_at = [time.monotonic() + 20]
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, count)
        print("ready", os.getpid())
        while time.monotonic() < end_at[0]:
            time.sleep(0.05)
        sys.exit(5)
    """,
}


def make_package(prefix, name, executables):
    index = prefix / 'share/ament_index/resource_index/packages'
    index.mkdir(parents=True, exist_ok=True)
    (index / name).touch()
    folder = prefix / 'lib' / name
    folder.mkdir(parents=True)
    for executable, code in executables.items():
        path = folder / executable
        head = f'#!{sys.executable} -u\nimport os, signal, sys, time\n'  # prints before it ends
        path.write_text(head + textwrap.dedent(code))
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
    (folder / 'notes.txt').touch()
    return folder


@pytest.fixture(scope='module', autouse=True)
def prefix(tmp_path_factory):
    prefix = tmp_path_factory.mktemp('workspace')
    folder = make_package(prefix, 'demo', EXECUTABLES)
    (folder / 'broken').write_text('#!/no/such/python\n')
    (folder / 'broken').chmod(0o755)
    (folder / 'deeper').mkdir()
    (folder / 'deeper/says').symlink_to(folder / 'fails')
    (folder / 'deeper/once').symlink_to(folder / 'says')
    before = os.environ['AMENT_PREFIX_PATH']
    os.environ['AMENT_PREFIX_PATH'] = f'{prefix}:{before}'
    yield prefix
    os.environ['AMENT_PREFIX_PATH'] = before


def test_arguments_are_passed_on_untouched():
    words = ['--ros-args', '-p', 'a:=1', '-h', '--prefix', 'x', '--', "it's"]
    result = ros2('run', 'demo', 'once', *words)
    assert (result.out, result.err, result.status) == (' '.join(words) + '\n', '', 0)


def test_a_prefix_comes_before_the_executable():
    result = ros2('run', '--prefix', "env A='b c'", 'demo', 'once', 'x')
    assert (result.out, result.err, result.status) == ('x\n', '', 0)


FAILURES = [
    ('demo fails', '[ros2run]: Process exited with failure 3\n', '', 3),
    ('demo dies', '[ros2run]: Killed\n', '', 256 - signal.SIGKILL),
    ('demo nothing', '', 'No executable found\n', 1),
    ('demo notes.txt', '', 'No executable found\n', 1),
    ('nothing says', '', "Package 'nothing' not found\n", 1),
    ('../x says', '', "Package '../x' not found\n", 1),
]


@pytest.mark.parametrize(('words', 'out', 'err', 'status'), FAILURES)
def test_a_failure_of_ros2_run_is_printed_as_by_ros2cli(words, out, err, status):
    result = ros2('run', *words.split())
    assert (result.out, result.err, result.status) == (out, err, status)


def test_an_ambiguous_executable_is_refused_with_all_its_paths(prefix):
    result = ros2('run', 'demo', 'says')
    paths = [prefix / 'lib/demo' / name for name in ('deeper/says', 'says')]
    assert result.err == f'Multiple executables found:\n- {paths[0]}\n- {paths[1]}\n'
    assert result.status == 1


@pytest.mark.parametrize('words', [('demo', 'broken'), ('--prefix', '/no/such', 'demo', 'once')])
def test_a_program_that_cannot_start_is_reported_in_one_sentence(words):
    result = ros2('run', *words)
    assert result.err.endswith('does not start: No such file or directory\n')
    assert result.status == 1


def test_a_prefix_with_an_unclosed_quote_is_refused():
    result = ros2('run', '--prefix', "'", 'demo', 'once')
    assert (result.err, result.status) == ('--prefix: No closing quotation: "\'"\n', 1)


SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.mark.parametrize('number', SIGNALS)
@pytest.mark.parametrize('to', ['the process', 'its group', 'both'])
def test_a_signal_reaches_the_executable_once(number, to):
    with started(SCRIPT, 'run', 'demo', 'counts', process_group=0) as process:
        assert process.stdout.readline().startswith('ready ')
        if to != 'its group':
            process.send_signal(number)
        if to != 'the process':  # Ctrl-C; and `timeout` does both
            os.killpg(process.pid, number)
        out, err = process.communicate(timeout=TIMEOUT_SEC)
    assert out == f'{number.name}\n[ros2run]: Process exited with failure 5\n'
    assert (err, process.returncode) == ('', 5)


def test_an_executable_in_the_background_of_a_script_can_be_interrupted():
    # there the shell has SIGINT ignored: Python would raise no KeyboardInterrupt, and rclpy's own
    # handler alone misses some signals
    script = f'"{SCRIPT}" run demo handles & wait'
    done = subprocess.run(['bash', '-c', script], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ('default_int_handler\n', '')


def test_the_executable_does_not_outlive_a_killed_command():
    with started(SCRIPT, 'run', 'demo', 'counts') as process:
        process.stdout.readline()
        process.kill()
        assert process.stdout.read() == 'SIGTERM\n'  # up to the end of the executable


def test_the_linux_command_timeout_ends_an_executable():
    done = subprocess.run(
        ['timeout', '-s', 'INT', '2', SCRIPT, 'run', 'demo', 'counts'],
        capture_output=True,
        encoding='utf-8',
        timeout=TIMEOUT_SEC,
    )
    assert done.stdout.splitlines()[1:] == [
        'SIGINT',
        '[ros2run]: Process exited with failure 5',
    ]
    assert done.stderr == ''


@pytest.fixture
def shell():
    shell = pexpect.spawn('bash', ['--norc', '--noediting'], encoding='utf-8', timeout=20)
    shell.sendline("PS1='$ '; stty -echo")
    shell.expect_exact('stty -echo\r\n')
    shell.expect_exact('$ ')
    yield shell
    shell.close(force=True)


# the terminal may still show what was counted meanwhile
STOPPED_BY_CTRL_C = r'SIGINT[\s\d]*\[ros2run\]: Process exited with failure 5'


def test_keyboard_input_at_a_terminal_goes_to_the_executable(shell):
    shell.sendline(f'"{SCRIPT}" run demo asks')
    time.sleep(1.0)
    shell.sendline('world')
    shell.expect_exact('hello world')
    shell.expect_exact('$ ')
    shell.sendline(f'"{SCRIPT}" run demo counts')
    shell.expect('ready')
    shell.sendintr()
    shell.expect(STOPPED_BY_CTRL_C)
    shell.expect_exact('$ ')


def test_an_executable_at_a_terminal_stops_at_ctrl_z_and_goes_on_at_fg(shell):
    shell.sendline(f'"{SCRIPT}" run demo counts')
    shell.expect('ready')
    shell.sendcontrol('z')
    shell.expect('Stopped')
    shell.expect_exact('$ ')
    shell.sendline('fg')
    shell.expect_exact('counts')
    time.sleep(0.5)
    shell.sendintr()
    shell.expect(STOPPED_BY_CTRL_C)


def test_packages_and_their_executables_are_listed(prefix):
    names = ros2('pkg', 'list').out.splitlines()
    assert names == sorted(names)
    assert {'demo', 'rclpy', 'sensor_msgs'} <= set(names)
    listed = ros2('pkg', 'executables', 'demo').out.splitlines()
    paths = ros2('pkg', 'executables', 'demo', '--full-path').out.splitlines()
    folder = prefix / 'lib/demo'
    expected = [
        'asks',
        'broken',
        'counts',
        'deeper/once',
        'deeper/says',
        'dies',
        'fails',
        'handles',
        'says',
    ]
    assert paths == [str(folder / path) for path in expected]
    assert listed == [f'demo {path.rpartition("/")[2]}' for path in expected]
    assert set(listed) <= set(ros2('pkg', 'executables').out.splitlines())


def test_a_prefix_is_the_first_one_on_the_path_that_has_the_package(prefix, tmp_path):
    make_package(tmp_path, 'demo', {})
    first = f'{tmp_path}:{prefix}'
    assert ros2('pkg', 'prefix', 'demo', AMENT_PREFIX_PATH=first).out == f'{tmp_path}\n'
    assert ros2('pkg', 'prefix', 'demo').out == f'{prefix}\n'
    assert ros2('pkg', 'prefix', 'demo', '--share').out == f'{prefix}/share/demo\n'
    # the virtual environment comes last, and needs no mention
    assert ros2('pkg', 'prefix', 'rclpy', AMENT_PREFIX_PATH='').out == f'{sys.prefix}\n'
    for words in (['nothing'], ['nothing', '--share'], ['a/b']):
        refused = ros2('pkg', 'prefix', *words)
        assert (refused.err, refused.status) == ('Package not found\n', 1)
    refused = ros2('pkg', 'executables', 'nothing')
    assert (refused.err, refused.status) == ("Package 'nothing' not found\n", 1)
