import multiprocessing
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import rclpy.context

from grader.common.parsing import COMMAND
from tests import ordinary, tiers
from tests.conftest import GUARD, LONG

TESTS = Path(__file__).parent
FILES = {
    path.stem: path
    for folder in (TESTS, TESTS.parent / 'my_robot_basics/test')
    for path in folder.glob('test_*.py')
}


def test_a_kernel_started_by_a_test_does_not_know_of_pytest():
    assert 'PYTEST_CURRENT_TEST' not in os.environ


def test_a_test_session_has_a_domain_of_its_own():
    assert 1 <= int(os.environ['ROS_DOMAIN_ID']) <= 101


@pytest.mark.parametrize('parts', [1, 2, 3])
def test_each_file_is_in_one_shard(parts):
    files = [Path(f'test_{letter}.py') for letter in 'aabbbcdde']
    items = [SimpleNamespace(path=path) for path in files]
    shards = []
    for part in range(1, parts + 1):
        mine = list(items)
        others = tiers.keep_shard(mine, f'{part}/{parts}')
        assert not {item.path for item in mine} & {item.path for item in others}
        assert len(mine) + len(others) == len(items)
        shards += mine
    assert sorted(item.path for item in shards) == files


@pytest.mark.parametrize('shard', ['0/2', '3/2', '1', '/', 'one/2'])
def test_an_invalid_shard_is_refused(shard):
    with pytest.raises(pytest.UsageError, match='expected K/N'):
        tiers.keep_shard([], shard)


def test_each_file_in_the_list_of_starting_files_exists():
    assert {f'test_{name}' for name in tiers.STARTING_FILES} - FILES.keys() == set()


def test_each_file_in_the_list_of_long_files_exists_and_is_listed_once():
    assert {f'test_{name}' for name in LONG} - FILES.keys() == set()
    assert len(set(LONG)) == len(LONG)


@pytest.mark.parametrize('row', ordinary.ORDINARY)
def test_each_row_of_the_ordinary_run_names_an_existing_test(row):
    file, _, name = row.partition('::')
    assert f'def {name}(' in FILES[file].read_text(encoding='utf-8')


@pytest.mark.parametrize(
    'start',
    [
        lambda: subprocess.run([sys.executable, '-m', 'ipykernel_launcher', '--version']),
        lambda: subprocess.run(['bash', '-c', 'ros2 --help']),
        lambda: subprocess.run(['bwrap', '--help']),
        lambda: subprocess.run(['chromium', '--version']),
        lambda: multiprocessing.get_context('spawn').Process(target=print).start(),
        lambda: os.posix_spawn(sys.executable, ['bwrap', '--help'], {}),
        os.fork,
        rclpy.context.Context().init,
    ],
    ids=['kernel', 'ros2', 'sandbox', 'browser', 'process', 'spawned', 'fork', 'node'],
)
def test_a_quick_test_that_starts_a_process_or_a_node_is_refused(start, monkeypatch, request):
    guard = request.config.stash[GUARD]
    monkeypatch.setattr(guard, 'refuses', True)
    with pytest.raises(RuntimeError, match='is not marked as a test that starts'):
        start()
    with pytest.raises(pytest.fail.Exception, match='and has no mark that says so'):
        guard.end()


def test_a_test_that_starts_a_process_without_the_mark_fails_in_an_ordinary_run(
    monkeypatch, request
):
    guard = request.config.stash[GUARD]
    monkeypatch.setattr(guard, 'refuses', False)
    subprocess.run(COMMAND, stdin=subprocess.DEVNULL)  # reads what students wrote: any test may
    os.waitpid(os.posix_spawn('/bin/true', ['true'], {}), 0)  # as subprocess does from 3.13 on
    guard.end()
    guard.begin(request.node)
    subprocess.run(['bwrap', '--help'], capture_output=True)
    with pytest.raises(pytest.fail.Exception, match='starts the process bwrap --help'):
        guard.end()
