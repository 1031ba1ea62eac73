"""How a kernel is started, what it knows, and what is left when it has gone."""

import asyncio
import os
import tempfile
import time
from pathlib import Path

import pytest
from grading_kernels import DOMAIN, IGNORES, processes_of, text_of
from jupyter_client.kernelspec import KernelSpec

from grader.common.errors import RoomFailure
from grader.kernels import kernels
from grader.kernels.kernel_manager import OurKernelSpec
from grader.kernels.kernels import GradingKernel

CHILDREN = """
import os, subprocess
subprocess.Popen(['sleep', '1000'])
subprocess.Popen(['sleep', '1000'], start_new_session=True)
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0: os.execvp('sleep', ['sleep', '1000'])
    os._exit(0)
"""


@pytest.mark.parametrize('code', ['pass', IGNORES], ids=['ended', 'killed'])
def test_nothing_that_a_cell_started_outlives_the_kernel(own_kernel, loop, run_cell, code):
    run_cell(own_kernel, CHILDREN)
    deadline = time.monotonic() + 30
    # one that is about to become another program shows no environment for a moment
    while (count := len(processes_of(own_kernel))) != 4 and time.monotonic() < deadline:
        time.sleep(0.05)
    assert count == 4
    run_cell(own_kernel, code, timeout_sec=0.5)
    loop.run(own_kernel.stop())
    assert processes_of(own_kernel) == []
    assert not own_kernel.folder.exists()


def test_a_thread_that_never_ends_does_not_keep_a_kernel_alive(own_kernel, loop, run_cell):
    run_cell(
        own_kernel,
        'import threading, time\nthreading.Thread(target=time.sleep, args=(1000,)).start()',
    )
    loop.run(own_kernel.stop())
    assert processes_of(own_kernel) == []


def test_a_kernel_leaves_no_file_and_no_descriptor(loop, run_cell):
    before = None
    for _ in range(2):
        kernel = GradingKernel(room='test', domain_id=DOMAIN, seed='ab')
        loop.run(kernel.start())
        assert run_cell(kernel, "open('left.txt', 'w').write('x')").ran_to_end
        loop.run(kernel.stop())
        loop.run(kernel.stop())  # twice does no harm
        assert not kernel.folder.exists()
        descriptors = len(os.listdir('/proc/self/fd'))
        before = before or descriptors
    assert descriptors <= before


def environment(run_cell, kernel):
    result = run_cell(
        kernel, "import os; print('\\n'.join(f'{k}={v}' for k, v in os.environ.items()))"
    )
    return dict(line.split('=', 1) for line in text_of(result).splitlines() if '=' in line)


@pytest.mark.parametrize('room', ['student', 'test'])
def test_a_kernel_has_only_the_environment_variables_of_its_room(
    loop, run_cell, monkeypatch, room
):
    forbidden = {
        'PYTHONPATH': '/tmp/nowhere',
        'PYTEST_CURRENT_TEST': 'x',
        'MY_ROBOT_BASICS_SEED': 'secret1',
        'SECRET_TOKEN': 'secret2',
        'ROS_DOMAIN_ID': '77',
    }
    for name, value in forbidden.items():
        monkeypatch.setenv(name, value)
    kernel = GradingKernel(room=room, domain_id=5, seed='abcd')
    loop.run(kernel.start())
    try:
        seen = environment(run_cell, kernel)
    finally:
        loop.run(kernel.stop())
    assert seen['MY_ROBOT_BASICS_ROOM'] == room
    assert seen['MY_ROBOT_BASICS_DOMAIN_ID'] == '5'
    assert seen.get('MY_ROBOT_BASICS_SEED') == {'test': 'abcd'}.get(room)
    assert not {'PYTHONPATH', 'PYTEST_CURRENT_TEST', 'SECRET_TOKEN', 'ROS_DOMAIN_ID'} & set(seen)
    assert not [v for v in seen.values() if 'secret' in v]


def test_a_kernel_works_in_an_empty_folder_and_imports_nothing_from_it(own_kernel, run_cell):
    code = "import os, sys; print(os.listdir(), {'', '.', os.getcwd()} & set(sys.path))"
    assert text_of(run_cell(own_kernel, code)) == '[] set()\n'


@pytest.mark.parametrize(
    ('argv', 'why'),
    [(['/bin/false'], 'its process ended'), (['/nowhere/python'], 'No such file')],
)
def test_a_kernel_that_does_not_start_is_the_graders_failure(loop, monkeypatch, argv, why):
    kernel = GradingKernel(room='test', domain_id=DOMAIN)
    spec = KernelSpec(argv=argv, language='python')
    monkeypatch.setattr(OurKernelSpec, 'get_kernel_spec', lambda self, name: spec)
    with pytest.raises(RoomFailure, match=f'the test kernel did not start: .*{why}'):
        loop.run(kernel.start())
    assert not kernel.folder.exists()


def test_a_kernel_that_never_answers_is_given_up(loop, monkeypatch):
    monkeypatch.setattr(kernels, 'START_TIMEOUT_SEC', 0.3)
    kernel = GradingKernel(room='test', domain_id=DOMAIN)
    spec = KernelSpec(argv=['sleep', '1000'], language='python')
    monkeypatch.setattr(OurKernelSpec, 'get_kernel_spec', lambda self, name: spec)
    with pytest.raises(RoomFailure, match='the test kernel did not start: TimeoutError'):
        loop.run(kernel.start())
    assert processes_of(kernel) == []


def test_cancelling_a_cell_leaves_a_kernel_that_can_be_stopped(own_kernel, loop):
    async def cancelled():
        task = asyncio.ensure_future(own_kernel.run('while True: pass', timeout_sec=600.0))
        await asyncio.sleep(0.3)
        task.cancel()
        await task

    with pytest.raises(asyncio.CancelledError):
        loop.run(cancelled())
    loop.run(own_kernel.stop())
    assert processes_of(own_kernel) == []


def test_a_long_path_for_temporary_files_is_not_used_for_sockets(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path / ('x' * 100)))
    kernel = GradingKernel(room='student', domain_id=DOMAIN)
    try:
        assert len(f'{kernel.paths.sockets}/zmq-10') < 107
    finally:
        asyncio.run(kernel.stop())
    assert not Path(kernel.folder).exists()
