"""Kernels that are forked into sandboxes of their own, for tests of forking."""

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
"""Slots that differ from claimed ROS domains and from those of other test processes."""
DOMAIN = 0
"""A domain that no test uses: these kernels make no nodes."""


async def opened(*, room='student', seed='', fresh=False):
    """Return a sandbox and a kernel in it; the kernel is forked, or started if `fresh`."""
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
    """Return the kernel's process, as seen from outside the sandbox."""
    process = kernel._manager.provisioner.process
    info = Path(f'/proc/self/fdinfo/{process._kernel}').read_text()
    return psutil.Process(int(re.search(r'^Pid:\s*(\d+)', info, re.MULTILINE)[1]))


def server_of(kernel):
    """Return the fork server: the parent of the process that waits for the kernel."""
    return process_of(kernel).parent().parent()
