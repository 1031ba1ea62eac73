"""The kernels in which nbval runs the lessons."""

import functools
import tempfile
from pathlib import Path
from typing import IO
from uuid import uuid4

import nbval.kernel
from jupyter_client.manager import KernelManager

_start = nbval.kernel.start_new_kernel


def prepare(sockets: Path) -> None:
    """Give nbval's kernels Unix sockets in a folder, and a message if one does not start."""
    # a TCP port that was chosen for a kernel may be taken by another program before it starts
    nbval.kernel.KernelManager = lambda **options: KernelManager(
        transport='ipc', ip=str(sockets / uuid4().hex), **options
    )
    nbval.kernel.start_new_kernel = start_kernel


@functools.wraps(_start)
def start_kernel(*arguments: object, stderr: IO[str], **options: object) -> tuple:
    """Start a kernel as nbval does. Raises RuntimeError with its stderr if it does not start."""
    stderr.close()  # nbval has opened /dev/null for it
    with tempfile.TemporaryFile('w+', errors='replace') as said:
        try:
            return _start(*arguments, stderr=said, **options)
        except RuntimeError as error:
            said.seek(0)
            raise RuntimeError(f'{error}. It said: {said.read() or "nothing"}') from error
