"""Python processes that are started in a room of a sandbox."""

import os
import subprocess
import sys
from contextlib import contextmanager

from grader.sandbox.sandbox import Sandbox

SLOTS = iter(range(200, 300))
"""Slots that differ from all claimed ROS domains."""


@contextmanager
def opened(loop):
    """Yield a sandbox, and close it at the end."""
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    yield sandbox
    loop.run(sandbox.close())


def begin(sandbox, code, *, room='student'):
    """Start Python in a room, with the environment of a kernel there."""
    paths = sandbox.paths(room)
    return subprocess.Popen(
        [*paths.prefix, sys.executable, '-c', code],
        env=paths.environment | {'LD_LIBRARY_PATH': os.environ.get('LD_LIBRARY_PATH', '')},
        pass_fds=paths.pass_fds,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def run(sandbox, code, *, room='student'):
    """Return what Python printed in a room."""
    return begin(sandbox, code, room=room).communicate(timeout=120)[0].strip()
