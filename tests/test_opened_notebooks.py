"""A notebook of somebody else's is opened: Jupyter starts its kernel, and no cell is run."""

import pytest
from jupyter_client import KernelManager

TIMEOUT_SEC = 60
HOSTILE = ('ipykernel_launcher', 'my_robot_basics', 'rclpy', 'IPython', 'comm', 'debugpy')
"""What a kernel imports at its start or later."""


@pytest.fixture
def opened(tmp_path, monkeypatch):
    """A client of a notebook's kernel, as Jupyter starts it, beside hostile modules."""
    for name in HOSTILE:
        (tmp_path / f'{name}.py').write_text(f'open({name + ".ran"!r}, "w")')
    (tmp_path / 'my_arm.py').write_text('LENGTH = 3')
    # not those of the person who runs the tests
    for name in ('JUPYTER_DATA_DIR', 'JUPYTER_RUNTIME_DIR', 'IPYTHONDIR'):
        monkeypatch.setenv(name, str(tmp_path.with_name('own') / name))
    manager = KernelManager(kernel_name='python3', transport='ipc', ip=f'{tmp_path}.zmq')
    manager.start_kernel(cwd=str(tmp_path))
    client = manager.client()
    client.start_channels()
    try:
        client.wait_for_ready(timeout=TIMEOUT_SEC)
        yield client
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def that_ran(folder):
    return sorted(path.stem for path in folder.glob('*.ran'))


def test_opening_a_notebook_runs_nothing_that_lies_beside_it(opened, tmp_path):
    assert that_ran(tmp_path) == []


def test_a_cell_imports_what_lies_beside_it_and_nothing_in_place_of_an_installed_module(
    opened, tmp_path
):
    cell = 'import my_arm, comm, rclpy; assert my_arm.LENGTH == 3 and rclpy.init'
    reply = opened.execute_interactive(cell, timeout=TIMEOUT_SEC)
    assert reply['content']['status'] == 'ok', reply['content']
    assert that_ran(tmp_path) == []
