"""Kernels that are forked into sandboxes of their own, for the tests of how that is done."""

import itertools
import os
import re
from pathlib import Path

import psutil
import pytest

from grader.kernels import fork_servers
from grader.kernels.kernels import GradingKernel
from grader.sandbox.sandbox import Sandbox

FIRST_SLOT = 1000 + os.getpid() % 400 * 100
SLOTS = itertools.count(FIRST_SLOT)
"""None that a claimed ROS domain gives, or another process of the tests uses."""
DOMAIN = 0
"""No kernel of these makes a node."""


async def opened(*, room='student', seed='', fresh=False):
    """Return a sandbox and a kernel in it; it is forked, unless it has to be started `fresh`."""
    sandbox = Sandbox(slot=next(SLOTS))
    await sandbox.open()
    kernel = GradingKernel(room=room, domain_id=DOMAIN, seed=seed, paths=sandbox.paths(room))
    with pytest.MonkeyPatch.context() as patch:
        if fresh:
            patch.setitem(fork_servers._unfit, room, 'the test says so')
        await kernel.start()
    assert kernel.why_not_forked == ('the test says so' if fresh else '')
    return sandbox, kernel


async def closed(sandbox, kernel):
    await kernel.stop()
    await sandbox.close()


def kernel_of(loop, **options):
    """Yield a kernel, as a fixture does."""
    sandbox, kernel = loop.run(opened(**options))
    yield kernel
    loop.run(closed(sandbox, kernel))


def printed(loop, kernel, code):
    """Return what a cell prints."""
    run = loop.run(kernel.run(code, timeout_sec=60.0))
    assert run.ran_to_end, run.error or run
    return ''.join(o.text for o in run.outputs)


def process_of(kernel):
    """Return the kernel's process as the machine knows it."""
    process = kernel._manager.provisioner.process
    info = Path(f'/proc/self/fdinfo/{process._kernel}').read_text()
    return psutil.Process(int(re.search(r'^Pid:\s*(\d+)', info, re.MULTILINE)[1]))


def server_of(kernel):
    """Return the process that the kernel was forked from; its parent is one that waits for it."""
    return process_of(kernel).parent().parent()
