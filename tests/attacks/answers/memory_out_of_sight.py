"""Fills shared memory and unmaps it, so that it shows up in no process."""

import mmap
import os
import time

PIECE = 100_000_000


def fill():
    kept = []
    while True:
        kept.append(memory := mmap.mmap(-1, PIECE))
        for page in range(0, PIECE, mmap.PAGESIZE):
            memory[page] = 1
        memory.madvise(mmap.MADV_DONTNEED)


for _ in range(3):
    if os.fork() == 0:
        try:
            fill()
        except (OSError, ValueError):
            time.sleep(1000)
time.sleep(8)
