"""Processes with a mark in their environment, which the processes that they start inherit."""

import contextlib

import psutil


def end(name: str, mark: str) -> None:
    """Kill all processes, as far as permitted, whose environment variable `name` is `mark`."""
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get(name) == mark:
                process.kill()
