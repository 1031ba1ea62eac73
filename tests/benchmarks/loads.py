"""What a machine may have to do beside: processors kept busy, memory nearly gone, slow disks.

    .venv/bin/python tests/benchmarks/loads.py KIND FOLDER

is one such process, until the one that started it ends; `beside` starts what it is asked for.
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
"""So little memory is left, that of files which may be read again included: programs lose pages
that they need …"""
PIECE_BYTES = 16 * 2**20
"""… and get or give back so much at a time."""
FILE_BYTES = 512 * 2**20
"""More than is left: who writes it, again and again, keeps the disk from all others."""


def keep_busy(_: Path) -> Iterator[None]:
    """Use a processor."""
    while True:
        yield


def use_memory(_: Path) -> Iterator[None]:
    """Take what memory there is, and give back what others ask for."""
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
    """Write a large file, wait until the disk has it, and read it from there."""
    path, piece = folder / f'load-{os.getpid()}', os.urandom(PIECE_BYTES)
    with path.open('w+b', buffering=0) as file:
        path.unlink()  # nothing stays, however this ends
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
"""What each does, and in how many processes."""


@contextmanager
def beside(kinds: Sequence[str], folder: Path) -> Iterator[None]:
    """Keep the machine so occupied, from now on; `folder` is on the disk that is meant.

    Raises RuntimeError at the end where such a process ended before.
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
    """Print at the end for how much of the time some process waited, and for what."""
    began, before = time.monotonic(), _stalled_sec()
    yield
    seconds = time.monotonic() - began
    told = (f'{what} {(now - before[what]) / seconds:.0%}' for what, now in _stalled_sec().items())
    print(f'some process waited for {", ".join(told)} of the time')


def _stalled_sec() -> dict[str, float]:
    """For how long so far some process waited for each, as Linux tells it (PSI)."""
    names = {'a processor': 'cpu', 'memory': 'memory', 'a disk': 'io'}
    lines = [Path('/proc/pressure', name).read_text('ascii') for name in names.values()]
    totals_us = (int(line.split()[4].partition('=')[2]) for line in lines)
    return {words: total_us / 1e6 for words, total_us in zip(names, totals_us, strict=True)}


def main(kind: str, folder: str) -> None:
    """Be such a process, first to go where memory runs out, no longer than who started it.

    Says when it has begun.
    """
    Path('/proc/self/oom_score_adj').write_text('1000', encoding='ascii')
    parent, occupied = os.getppid(), KINDS[kind][0](Path(folder))
    next(occupied)
    print('begun', flush=True)
    while os.getppid() == parent:
        next(occupied)


if __name__ == '__main__':
    main(*sys.argv[1:])
