"""For tests: a node of this folder in a process of its own, or imported."""

import contextlib
import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import forked
from my_robot_basics.checks import graph

FOLDER = Path(__file__).parent


@contextlib.contextmanager
def running(name: str) -> Iterator[None]:
    """Run `<name>.py` for the duration of a with statement, once a node of it is up.

    Its logs go nowhere. Other nodes of the domain count as up, too.
    """
    process = forked.start(FOLDER / f'{name}.py')
    try:
        # a slow start is not what the tests are about
        while process.is_alive() and not graph().nodes():
            pass
        yield
    finally:
        forked.stop(process)


def imported(name: str) -> ModuleType:
    """The module `<name>.py`; the nodes import each other by their plain names."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))
    return importlib.import_module(name)
