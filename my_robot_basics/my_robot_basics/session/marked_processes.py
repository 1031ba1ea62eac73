"""Processes that have a mark in their environment, as all do that one of them has started."""

import contextlib

import psutil


def end(name: str, mark: str) -> None:
    """Kill the processes that can be killed and in whose environment `name` has that value."""
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get(name) == mark:
                process.kill()
