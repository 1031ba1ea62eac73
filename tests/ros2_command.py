"""For tests: the console script `ros2` as a process, and nodes for it to look at."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import forked
import my_robot_basics.ros2.start
from my_robot_basics.live import domain

SCRIPT = Path(sys.executable).with_name('ros2')
START = my_robot_basics.ros2.start.__file__
"""What the script runs."""
NODES = Path(__file__).parent / 'nodes'
PATIENCE_SEC = 30


def ros2(*words: str, stdin: str = '', **environment: str) -> forked.Ended:
    """Run the command to its end."""
    return forked.run(
        *(START, 'ros2.main', *words), stdin=stdin, patience_sec=PATIENCE_SEC, **environment
    )


@contextlib.contextmanager
def started(*words: str | Path, **options: object) -> Iterator[subprocess.Popen]:
    """Run a command for the duration of a with statement, its output in pipes."""
    pipes = {'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE, 'encoding': 'utf-8'}
    process = subprocess.Popen([str(word) for word in words], **{**pipes, **options})
    try:
        yield process
    finally:
        process.terminate()  # in good order: whoever is killed stays on the graph for a while
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@contextlib.contextmanager
def on_the_graph(*names: str, topics: tuple[str, ...] = ()) -> Iterator[None]:
    """Nodes of `tests/nodes/`, once their topics are on the graph."""
    nodes = [forked.start(NODES / f'{name}.py') for name in names]
    try:
        shown: list[str] = []
        while not set(topics) <= set(shown):
            assert all(node.is_alive() for node in nodes), 'a node has died'
            shown = ros2(
                'topic', 'list', '--no-daemon', '--include-hidden-topics'
            ).out.splitlines()
        yield
    finally:
        for node in nodes:
            forked.stop(node)


@contextlib.contextmanager
def own_domain() -> Iterator[None]:
    """A ROS domain in which no other test has left a node."""
    before = os.environ['ROS_DOMAIN_ID']
    claim = domain.claim()
    os.environ['ROS_DOMAIN_ID'] = str(claim.domain_id)
    try:
        yield
    finally:
        os.environ['ROS_DOMAIN_ID'] = before
        claim.release()
