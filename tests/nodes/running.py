"""For tests: a node of this folder in a process of its own, or imported."""

import contextlib
import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from my_robot_basics.checks import graph

from my_robot_basics import live

FOLDER = Path(__file__).parent
TIMEOUT_SEC = 5.0
STOPS = []
"""Functions that end the threads that nodes have started."""


def stop_all() -> None:
    """End these threads before the nodes: they would use nodes that are destroyed."""
    while STOPS:
        STOPS.pop()()
    live.stop()


@contextlib.contextmanager
def running(name: str) -> Iterator[None]:
    """Run `<name>.py` for the duration of a with statement, once a node of it is up.

    Its logs go nowhere. Other nodes of the domain count as up, too.
    """
    command = [sys.executable, FOLDER / f'{name}.py']
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        # a slow start is not what the tests are about
        while process.poll() is None and not graph().nodes():
            pass
        yield
    finally:
        # first in good order: a process that is killed stays on the graph as a ghost for a while
        process.terminate()
        try:
            process.wait(TIMEOUT_SEC)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def imported(name: str) -> ModuleType:
    """The module `<name>.py`; the nodes import each other by their plain names."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))
    return importlib.import_module(name)
