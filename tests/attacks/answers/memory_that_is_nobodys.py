"""Fills memory that counts for no process: shared, System V, and files in memory."""

import ctypes
import mmap
import os
import time

SIZE = 50_000_000
kept = []


def in_a_file():
    kept.append(file := os.memfd_create('bomb'))
    os.write(file, b'x' * SIZE)


def shared():
    kept.append(memory := mmap.mmap(-1, SIZE))
    memory.write(b'x' * SIZE)


def system_v():
    system = ctypes.CDLL(None)
    system.shmat.restype = ctypes.c_void_p
    place = system.shmat(system.shmget(0, ctypes.c_size_t(SIZE), 0o1600), None, 0)
    if place != ctypes.c_void_p(-1).value:
        ctypes.memset(place, 1, SIZE)
        system.shmdt(ctypes.c_void_p(place))


for fill in in_a_file, system_v, shared:
    for _ in range(50):
        try:
            fill()
        except (OSError, ValueError):
            break
time.sleep(5)
