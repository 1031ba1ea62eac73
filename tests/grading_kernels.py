"""Kernels of the grader without a sandbox, for tests of a single kernel."""

from collections.abc import Iterator
from contextlib import contextmanager

import psutil

from grader.kernels.kernels import GradingKernel

DOMAIN = 0
"""A domain that no test uses: these kernels make no nodes."""
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
    """Keeps the kernel that the last test used, if it is still alive."""

    def __init__(self, loop):
        self.loop = loop
        self.left = []

    @contextmanager
    def kernel(self) -> Iterator[GradingKernel]:
        """Yield a kernel for a cell that leaves nothing behind; the next test may reuse it."""
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
    """Return a function that runs a cell in a kernel."""

    def run(kernel, code, timeout_sec=60.0, **more):
        return loop.run(kernel.run(code, timeout_sec=timeout_sec, **more))

    return run


def text_of(cell_run):
    return ''.join(o.get('text', '') for o in cell_run.outputs)


def processes_of(kernel):
    """Return the processes with the kernel's environment, including the kernel itself."""
    marker = str(kernel.folder)
    found = []
    for process in psutil.process_iter():
        try:
            if marker in process.environ().get('IPYTHONDIR', ''):
                found.append(process.pid)
        except psutil.Error:
            continue
    return found
