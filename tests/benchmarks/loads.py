"""Loads on the machine during a measurement: busy processors, little memory, a busy disk.

    .venv/bin/python tests/benchmarks/loads.py KIND FOLDER

is one process of a load, which ends with its parent process; `beside` starts the loads.
"""

import mmap
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import psutil

LEFT_BYTES = 100 * 2**20
"""The memory that is left available, including the page cache: programs lose pages that they
need."""
PIECE_BYTES = 16 * 2**20
"""How much memory is taken or given back at a time."""
FILE_BYTES = 512 * 2**20
"""More than LEFT_BYTES: writing this again and again keeps the disk busy."""


def keep_busy(_: Path) -> Iterator[None]:
    """Use one processor."""
    while True:
        yield


def use_memory(_: Path) -> Iterator[None]:
    """Take all memory but LEFT_BYTES, and give some back when other processes need it."""
    taken: list[mmap.mmap] = []
    while True:
        left = psutil.virtual_memory().available
        if left > LEFT_BYTES + PIECE_BYTES:
            taken.append(mmap.mmap(-1, PIECE_BYTES, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS))
            taken[-1].write(b'1' * PIECE_BYTES)
            continue
        if left < LEFT_BYTES - PIECE_BYTES and taken:
            taken.pop().close()
        else:
            time.sleep(0.01)
        yield


def use_disk(folder: Path) -> Iterator[None]:
    """Write a large file, wait until it is on the disk, and read it from there."""
    path, piece = folder / f'load-{os.getpid()}', os.urandom(PIECE_BYTES)
    with path.open('w+b', buffering=0) as file:
        path.unlink()  # so no file remains, however this process ends
        while True:
            file.seek(0)
            for _ in range(FILE_BYTES // PIECE_BYTES):
                file.write(piece)
                os.fsync(file.fileno())
                yield
            os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
            file.seek(0)
            while file.read(PIECE_BYTES):
                yield


KINDS: dict[str, tuple[Callable[[Path], Iterator[None]], int]] = {
    'busy': (keep_busy, 2),
    'memory': (use_memory, 1),
    'disk': (use_disk, 2),
}
"""By kind of load: its function, and the number of its processes."""


@contextmanager
def beside(kinds: Sequence[str], folder: Path) -> Iterator[None]:
    """Keep these loads on the machine during the block; `folder` is on the disk to use.

    Raises RuntimeError at the end if a process of a load has ended early.
    """
    started = [
        subprocess.Popen([sys.executable, __file__, kind, str(folder)], stdout=subprocess.PIPE)
        for kind in kinds
        for _ in range(KINDS[kind][1])
    ]
    with ExitStack() as ends:
        for process in started:
            ends.callback(process.wait)
            ends.callback(process.kill)
        for process in started:
            process.stdout.readline()
        yield
        if any(process.poll() is not None for process in started):
            raise RuntimeError(f'{", ".join(kinds)} ended before what was measured beside it')


@contextmanager
def telling_pressure() -> Iterator[None]:
    """Print at the end the share of time in which some process waited, by resource."""
    began, before = time.monotonic(), _stalled_sec()
    yield
    seconds = time.monotonic() - began
    told = (f'{what} {(now - before[what]) / seconds:.0%}' for what, now in _stalled_sec().items())
    print(f'some process waited for {", ".join(told)} of the time')


def _stalled_sec() -> dict[str, float]:
    """Return how long some process has waited for each resource so far, from Linux's PSI."""
    names = {'a processor': 'cpu', 'memory': 'memory', 'a disk': 'io'}
    lines = [Path('/proc/pressure', name).read_text('ascii') for name in names.values()]
    totals_us = (int(line.split()[4].partition('=')[2]) for line in lines)
    return {words: total_us / 1e6 for words, total_us in zip(names, totals_us, strict=True)}


def main(kind: str, folder: str) -> None:
    """Run one process of a load until its parent ends; the OOM killer ends it first.

    It prints a line when it has begun.
    """
    Path('/proc/self/oom_score_adj').write_text('1000', encoding='ascii')
    parent, occupied = os.getppid(), KINDS[kind][0](Path(folder))
    next(occupied)
    print('begun', flush=True)
    while os.getppid() == parent:
        next(occupied)


if __name__ == '__main__':
    main(*sys.argv[1:])
