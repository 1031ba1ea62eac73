"""The console script `ros2` as a process, and nodes for it to find, for tests."""

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from my_robot_basics.session import domain

SCRIPT = Path(sys.executable).with_name('ros2')
NODES = Path(__file__).parent / 'nodes'
TIMEOUT_SEC = 90
"""How long a command may take: beside other tests, its start alone may take half a minute."""
MOST_SEC = 120
"""If an expected line does not come for so long, the process is killed, and the test fails."""
OF_A_LESSON = ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'FASTRTPS_DEFAULT_PROFILES_FILE')
"""Variables that nodes outside of the course do not have."""


@dataclass(frozen=True)
class Result:
    status: int
    out: str
    err: str


def ros2(*words: str, stdin: str = '', **environment: str) -> Result:
    """Run the command to its end."""
    done = subprocess.run(
        [SCRIPT, *words],
        input=stdin,
        capture_output=True,
        encoding='utf-8',
        timeout=TIMEOUT_SEC,
        env={**os.environ, **environment},
    )
    return Result(done.returncode, done.stdout, done.stderr)


@contextlib.contextmanager
def started(*words: str | Path, **options: object) -> Iterator[subprocess.Popen]:
    """Run a command during a with block, with its output in pipes."""
    pipes = {'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE, 'encoding': 'utf-8'}
    process = subprocess.Popen([str(word) for word in words], **{**pipes, **options})
    watchdog = threading.Timer(MOST_SEC, process.kill)
    watchdog.start()
    try:
        yield process
    finally:
        watchdog.cancel()
        process.terminate()  # not killed, because a killed node stays on the graph for a while
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@contextlib.contextmanager
def on_the_graph(*names: str, topics: tuple[str, ...] = ()) -> Iterator[None]:
    """Run nodes of `tests/nodes/`; yield when their topics are on the graph."""
    quiet = {'stdout': subprocess.DEVNULL, 'stderr': subprocess.DEVNULL}
    with contextlib.ExitStack() as stack:
        paths = [NODES / f'{name}.py' for name in names]
        nodes = [stack.enter_context(started(sys.executable, path, **quiet)) for path in paths]
        shown: list[str] = []
        while not set(topics) <= set(shown):
            assert all(node.poll() is None for node in nodes), 'a node has died'
            shown = ros2(
                'topic', 'list', '--no-daemon', '--include-hidden-topics'
            ).out.splitlines()
        yield


@contextlib.contextmanager
def plain_nodes(nodes: int, contexts: int) -> Iterator[subprocess.Popen]:
    """Run `nodes/plain.py`, which does not use the course's packages."""
    environment = {name: value for name, value in os.environ.items() if name not in OF_A_LESSON}
    with started(
        *(sys.executable, NODES / 'plain.py', str(nodes), str(contexts)), env=environment
    ) as process:
        assert process.stdout.readline() == 'up\n'
        yield process


@contextlib.contextmanager
def own_domain() -> Iterator[None]:
    """Use a ROS domain without nodes of other tests."""
    before = os.environ['ROS_DOMAIN_ID']
    claim = domain.claim()
    os.environ['ROS_DOMAIN_ID'] = str(claim.domain_id)
    try:
        yield
    finally:
        os.environ['ROS_DOMAIN_ID'] = before
        claim.release()
