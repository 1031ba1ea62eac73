"""For tests: a node of this folder in a process of its own, or imported."""

import contextlib
import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

FOLDER = Path(__file__).parent
PATIENCE_SEC = 5.0


@contextlib.contextmanager
def running(name: str) -> Iterator[None]:
    """Run `<name>.py` for the duration of a with statement; its logs go nowhere."""
    command = [sys.executable, FOLDER / f'{name}.py']
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        # first in good order: whoever is killed stays on the graph as a ghost for a while
        process.terminate()
        try:
            process.wait(PATIENCE_SEC)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def imported(name: str) -> ModuleType:
    """The module `<name>.py`; the nodes import each other by their plain names."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))
    return importlib.import_module(name)
