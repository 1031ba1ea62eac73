"""Temporary folders of graders are removed when their process ends, or the next one starts."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from grader.sandbox import temporary_folders
from grader.sandbox.kernel_paths import make_folder
from grader.sandbox.temporary_folders import PREFIX, own_folder, remove_stale_folders

GRADER = """
import sys
from grader.sandbox.kernel_paths import make_folder
folder = make_folder('student')
(folder / 'given' / 'files' / 'x.py').write_text('')
print(folder.parent, flush=True)
sys.stdin.read()
"""


@pytest.fixture
def start(tmp_path):
    """Starts processes that have folders in a temporary folder of this test's."""
    started = []

    def start_one():
        process = subprocess.Popen(
            [sys.executable, '-P', '-c', GRADER],
            env=os.environ | {'TMPDIR': str(tmp_path)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process, Path(process.stdout.readline().strip())

    yield start_one
    for process in started:
        process.kill()
        process.communicate()


@pytest.fixture
def tmp_path():
    """A short path, as that of /tmp is."""
    with tempfile.TemporaryDirectory(prefix='mrb-test-') as folder:
        yield Path(folder)


def test_folders_of_a_killed_grader_are_removed_when_the_next_one_starts(tmp_path, start):
    (killed, left), (other, others) = start(), start()
    killed.kill()
    killed.wait()
    assert list(left.rglob('x.py'))
    _, new = start()
    assert sorted(tmp_path.iterdir()) == sorted([others, new])
    assert list(others.rglob('x.py'))  # its grader still runs
    other.communicate('')
    assert list(tmp_path.iterdir()) == [new]


def test_a_process_has_one_folder_that_no_other_user_can_enter():
    folder = make_folder('student')
    other = make_folder('test')
    assert folder.parent == other.parent == own_folder()
    assert own_folder().stat().st_mode & 0o777 == 0o700
    assert own_folder() not in remove_stale_folders(own_folder().parent)
    assert len(str(folder / 'kernel' / 'zmq-1')) < 107
    for each in (folder, other):
        assert not [path for path in each.rglob('*') if not path.is_dir()]
        shutil.rmtree(each)


def test_a_long_temporary_path_is_replaced_by_one_in_tmp(monkeypatch):
    monkeypatch.setattr(temporary_folders.tempfile, 'gettempdir', lambda: '/' + 'x' * 60)
    assert own_folder().parent == Path('/tmp')


def test_sweeping_follows_no_links_and_removes_only_abandoned_folders(tmp_path, monkeypatch):
    precious = tmp_path / 'precious'
    precious.mkdir()
    (precious / 'kept.txt').write_text('')
    (tmp_path / f'{PREFIX}link').symlink_to(precious)
    (tmp_path / f'{PREFIX}file').write_text('')
    (tmp_path / 'mrb-other').mkdir()
    left = tmp_path / f'{PREFIX}left'
    left.mkdir()
    (left / 'way_out').symlink_to(precious)
    before = sorted(tmp_path.iterdir())
    monkeypatch.setattr(os, 'geteuid', lambda: os.getuid() + 1)
    assert remove_stale_folders(tmp_path) == []  # another user's
    monkeypatch.undo()
    assert remove_stale_folders(tmp_path) == [left]
    assert sorted(tmp_path.iterdir()) == [path for path in before if path != left]
    assert (precious / 'kept.txt').exists()


def test_a_forked_process_does_not_remove_the_folder_of_its_parent(tmp_path, start):
    folder = own_folder()
    child = os.fork()
    if child == 0:
        temporary_folders._remove(folder, os.getppid())
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    assert folder.is_dir()
