"""Processes that have a mark in their environment, as all do that one of them has started."""

import contextlib

import psutil


def end(name: str, mark: str, *, but_below: int | None = None) -> None:
    """Kill the processes that can be killed and in whose environment `name` has that value.

    With the id of a process, spare it and what is below it: the others were left alone.
    """
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get(name) == mark and not _is_below(process, but_below):
                process.kill()


def _is_below(process: psutil.Process, pid: int | None) -> bool:
    return pid is not None and pid in (process.pid, *(each.pid for each in process.parents()))
