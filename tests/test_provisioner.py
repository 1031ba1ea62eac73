"""The sandboxed kernel by its name, as nbclient, JupyterLab and nbgrader start it."""

import asyncio
import json
import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import nbformat
import psutil
import pytest
from jupyter_client import AsyncKernelManager, KernelManager
from jupyter_client.kernelspec import KernelSpecManager
from nbclient import NotebookClient
from nbclient.exceptions import CellTimeoutError

from grader.common.errors import RoomFailure
from grader.course import ROOT
from grader.kernels import fork_servers
from grader.kernels.provisioner import NAME, SandboxProvisioner
from grader.sandbox import sandbox

pytestmark = [pytest.mark.isolation, pytest.mark.usefixtures('signals')]

SPEC = Path(sys.prefix, 'share', 'jupyter', 'kernels', NAME, 'kernel.json')


@pytest.fixture(autouse=True)
def no_server_before():
    """Close all fork servers, so that processes which a test leaves can be counted."""
    fork_servers.close_servers()


def notebook(*sources):
    return nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in sources])


def run(*sources, **options):
    """Return what each cell printed, as nbclient ran it."""
    client = NotebookClient(notebook(*sources), kernel_name=NAME, **options)
    ran = client.execute()
    return [''.join(o.get('text', '') for o in cell.outputs) for cell in ran.cells]


def test_jupyter_finds_the_kernel_and_its_provisioner():
    (entry,) = entry_points(group='jupyter_client.kernel_provisioners', name=NAME)
    assert entry.load() is SandboxProvisioner
    assert json.loads(SPEC.read_text()) == json.loads(
        (ROOT / 'grader' / 'kernels' / 'kernelspec' / 'kernel.json').read_text()
    )
    spec = KernelSpecManager().get_kernel_spec(NAME)
    assert (spec.interrupt_mode, spec.language) == ('message', 'python')
    listed = subprocess.run(
        [sys.executable, '-m', 'jupyter', 'kernelspec', 'list', '--json'],
        capture_output=True,
        text=True,
    )
    assert NAME in json.loads(listed.stdout)['kernelspecs']


LOOK = f"""
import os
print([line.split(':')[0].strip() for line in open('/proc/net/dev')][2:])
print(os.path.exists({str(ROOT / 'solutions')!r}), os.path.exists({str(ROOT / 'tests')!r}))
print('SECRET' in os.environ, os.getcwd(), os.listdir(), os.environ.get('MY_ROBOT_BASICS_SEED'))
print(open('/proc/self/status').read().split('Seccomp:')[1].split()[0])
"""
ROS = """
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node('in_a_sandbox')
heard = []
node.create_subscription(String, 'said', lambda message: heard.append(message.data), 10)
publisher = node.create_publisher(String, 'said', 10)
import time
deadline = time.monotonic() + 60
while not heard and time.monotonic() < deadline:
    publisher.publish(String(data='hello'))
    rclpy.spin_once(node, timeout_sec=0.1)
print(heard[0])
"""


@pytest.fixture
def left(monkeypatch):
    """What kernels that a test started have left: processes, folders."""
    made, mkdtemp = [], sandbox.make_folder

    def make_folder(name):
        made.append(mkdtemp(name))
        return made[-1]

    monkeypatch.setattr(sandbox, 'make_folder', make_folder)
    before = {p.pid for p in psutil.Process().children(recursive=True)}

    def left():
        children = {p.pid for p in psutil.Process().children(recursive=True)} - before
        assert made
        return len(children), [folder for folder in made if folder.exists()]

    return left


def test_a_notebook_of_the_sandboxed_kernel_runs_isolated(monkeypatch, tmp_path, left):
    monkeypatch.setenv('SECRET', 'x')
    (tmp_path / 'hidden_tests.py').write_text('')
    looked, ros = run(LOOK, ROS, resources={'metadata': {'path': str(tmp_path)}})
    assert looked.splitlines() == ["['lo']", 'False False', 'False /room/home/work [] None', '2']
    assert ros == 'hello\n'
    assert left() == (0, [])


@pytest.mark.slow
def test_a_cell_that_takes_too_long_is_interrupted_and_the_kernel_goes_on(left):
    client = NotebookClient(
        notebook('x = 5', 'while True: pass', 'print(x)'),
        kernel_name=NAME,
        timeout=2,
        interrupt_on_timeout=True,
        allow_errors=True,
    )
    cells = client.execute().cells
    assert cells[1].outputs[0].ename == 'KeyboardInterrupt'
    assert cells[2].outputs[0].text == '5\n'
    assert left() == (0, [])


@pytest.mark.slow
def test_a_cell_timeout_without_an_interrupt_ends_the_kernel(left):
    with pytest.raises(CellTimeoutError):
        run('while True: pass', timeout=1)
    assert left() == (0, [])


def test_a_kernel_is_forked_and_restarted_in_its_sandbox(left):
    async def life():
        manager = AsyncKernelManager(kernel_name=NAME)
        await manager.start_kernel()
        assert manager.provisioner.why_not_forked == ''
        assert manager.provisioner.resolve_path('/etc/passwd') is None
        said = [await first_word(manager, "open('kept', 'w').close()")]
        await manager.restart_kernel(now=True)
        said.append(await first_word(manager, "import os; print(os.listdir(), 'x' in dir())"))
        assert await manager.is_alive()
        await manager.shutdown_kernel()
        assert not await manager.is_alive()
        return said

    assert asyncio.run(life()) == ['', "['kept'] False\n"]
    assert left() == (0, [])


async def first_word(manager, code):
    client = manager.client()
    client.start_channels()
    try:
        await client.wait_for_ready(timeout=60)
        said = []

        def hear(message):
            if message['msg_type'] == 'stream':
                said.append(message['content']['text'])

        await client.execute_interactive(code, timeout=60, output_hook=hear)
        return ''.join(said)
    finally:
        client.stop_channels()


def test_a_kernel_manager_without_an_event_loop_starts_the_kernel(left):
    manager = KernelManager(kernel_name=NAME)
    manager.start_kernel()
    client = manager.client()
    client.start_channels()
    client.wait_for_ready(timeout=60)
    reply = client.execute_interactive('import os; assert os.getuid() == 1000', timeout=60)
    assert reply['content']['status'] == 'ok'
    client.stop_channels()
    manager.shutdown_kernel()
    assert left() == (0, [])


def test_no_cell_runs_if_there_is_no_sandbox(monkeypatch, left):
    monkeypatch.setattr('grader.sandbox.bubblewrap._HOLD', 'echo no namespaces >&2; exit 1')
    with pytest.raises(RoomFailure, match='no namespaces'):
        run("open('/tmp/it_ran', 'w')")
    assert not os.path.exists('/tmp/it_ran')
    assert left() == (0, [])
