"""A forked program is as good as a started one: what it finds, what it leaves, how it ends."""

import signal
import subprocess
import sys

import forked
import pytest

LOOKS = """
import os, signal, sys, threading
print(sys.argv, sys.path[0], os.getcwd(), os.environ['WORD'], 'HOME' in os.environ)
print(input(), __name__, [thread.name for thread in threading.enumerate()])
print(signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM))
print(sys.stdout.isatty(), sys.stdout.encoding, sys.stdout.line_buffering, 'é')
print(sys.stdin.encoding, sys.__name__, repr(sys.stdin.read()))
"""
BEGINS = 'import atexit, os, signal, sys, threading\nprint("begun", flush=True)\n'
ENDS = {
    'at its end': 'pass',
    'with a status': 'sys.exit(3)',
    'with a sentence': 'sys.exit("no such topic")',
    'with an error': '1 / 0',
    'by a signal': 'os.kill(os.getpid(), signal.SIGTERM)',
    'with what was left to do': 'atexit.register(print, "last words"); sys.exit(2)',
    'with a thread': 'threading.Timer(0.2, print, ["later"]).start()',
}


def both(path, *arguments, stdin='', **environment):
    """What comes of a program that is started, and of one that is forked."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in environment.items():
            patch.setenv(name, value)
        done = subprocess.run(
            [sys.executable, path, *arguments], input=stdin, capture_output=True, encoding='utf-8'
        )
    started = forked.Ended(done.returncode, done.stdout, done.stderr)
    return started, forked.run(path, *arguments, stdin=stdin, patience_sec=30.0, **environment)


def test_it_finds_what_a_started_one_finds(tmp_path, monkeypatch):
    path = tmp_path / 'looks.py'
    path.write_text(LOOKS)
    monkeypatch.chdir(tmp_path)
    started, ended = both(path, '-x', 'two words', stdin='line\nmore\n', WORD='said')
    assert ended == started
    assert "'-x', 'two words'" in ended.out
    assert (ended.status, ended.err) == (0, '')


@pytest.mark.parametrize('code', ENDS.values(), ids=ENDS)
def test_it_ends_as_a_started_one_ends(code, tmp_path):
    path = tmp_path / 'ends.py'
    path.write_text(f'{BEGINS}{code}')
    started, ended = both(path)
    assert (ended.status, ended.out) == (started.status, started.out)
    assert ended.err.splitlines()[-1:] == started.err.splitlines()[-1:]


def test_rclpy_is_there_before_the_program_begins(tmp_path):
    path = tmp_path / 'imported.py'
    path.write_text('import sys; print("rclpy" in sys.modules)')
    _, ended = both(path)
    assert ended.out == 'True\n'


def test_what_does_not_end_is_ended(tmp_path):
    path = tmp_path / 'stays.py'
    path.write_text('import signal\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\nsignal.pause()')
    with pytest.raises(TimeoutError, match=r'stays\.py.* has not ended in 0\.5 s'):
        forked.run(path, stdin='', patience_sec=0.5)
    process = forked.start(path)
    forked.stop(process, patience_sec=0.5)
    assert process.exitcode in (-signal.SIGTERM, -signal.SIGKILL)
