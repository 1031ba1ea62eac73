"""Kernels of the grader that no sandbox is around, for the tests of one kernel."""

from collections.abc import Iterator
from contextlib import contextmanager

import psutil

from grader.kernels.kernels import GradingKernel

DOMAIN = 0
"""None of them makes a node."""
IGNORES = """
import signal, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
while True: time.sleep(1)
"""


@contextmanager
def opened_kernel(loop) -> Iterator[GradingKernel]:
    """Start the kernel of a student's room; stop it at the end."""
    kernel = GradingKernel(room='student', domain_id=DOMAIN)
    loop.run(kernel.start())
    yield kernel
    loop.run(kernel.stop())


class Spares:
    """The kernel that the last test has left, if one has."""

    def __init__(self, loop):
        self.loop = loop
        self.left = []

    @contextmanager
    def kernel(self) -> Iterator[GradingKernel]:
        """A kernel for a cell that leaves nothing in it: where it lives on, the next has it."""
        kernel = self.left.pop() if self.left else GradingKernel(room='student', domain_id=DOMAIN)
        if not kernel.alive:
            self.loop.run(kernel.start())
        yield kernel
        if kernel.alive:
            self.left.append(kernel)
        else:
            self.loop.run(kernel.stop())

    def stop(self):
        for kernel in self.left:
            self.loop.run(kernel.stop())


def runs_in(loop):
    """Return what runs a cell in a kernel."""

    def run(kernel, code, timeout_sec=60.0, **more):
        return loop.run(kernel.run(code, timeout_sec=timeout_sec, **more))

    return run


def text_of(cell_run):
    return ''.join(o.get('text', '') for o in cell_run.outputs)


def processes_of(kernel):
    """Return whatever runs with the kernel's own environment, the kernel itself included."""
    marker = str(kernel.folder)
    found = []
    for process in psutil.process_iter():
        try:
            if marker in process.environ().get('IPYTHONDIR', ''):
                found.append(process.pid)
        except psutil.Error:
            continue
    return found
