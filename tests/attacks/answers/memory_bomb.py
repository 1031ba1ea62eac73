"""Fills the memory, in one process and then in many."""

import os

for _ in range(3):
    os.fork()
kept = []
while True:
    try:
        kept.append(bytearray(b'x' * 10_000_000))
    except MemoryError:
        kept.append(None)
