"""A kernel of nbval needs no port, and is reported with its output if it does not start."""

import json

import nbval.kernel
import pytest

from tests import lesson_kernels


@pytest.fixture(autouse=True)
def prepared(monkeypatch, tmp_path):
    for name in ('KernelManager', 'start_new_kernel'):
        monkeypatch.setattr(nbval.kernel, name, getattr(nbval.kernel, name))
    monkeypatch.setenv('JUPYTER_PATH', str(tmp_path))
    lesson_kernels.prepare(tmp_path)


@pytest.mark.starts
def test_a_kernel_that_does_not_start_is_reported_with_its_last_output(tmp_path):
    spec = tmp_path / 'kernels/broken/kernel.json'
    spec.parent.mkdir(parents=True)
    command = ['sh', '-c', 'echo no room is left >&2; exit 3']
    spec.write_text(json.dumps({'argv': command, 'display_name': 'broken', 'language': 'python'}))
    with pytest.raises(RuntimeError, match=r'died before .* It said: no room is left\n'):
        nbval.kernel.RunningKernel('broken', cwd=str(tmp_path))


@pytest.mark.starts
def test_each_kernel_has_sockets_of_its_own(tmp_path):
    kernels = [nbval.kernel.RunningKernel('python3', cwd=str(tmp_path)) for _ in range(2)]
    try:
        managers = [kernel.km for kernel in kernels]
        assert [manager.transport for manager in managers] == ['ipc', 'ipc']
        assert len({manager.ip for manager in managers}) == 2
    finally:
        for kernel in kernels:
            kernel.stop()
