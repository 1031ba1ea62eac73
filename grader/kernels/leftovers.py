"""Processes that a kernel without a sandbox started and left behind."""

import asyncio
import contextlib
import time

import psutil


async def kill_leftovers(ipython_folder: str, *, timeout_sec: float) -> None:
    """Kill processes that left the kernel's process group but kept its environment."""
    deadline = time.monotonic() + timeout_sec
    while (left := _leftovers(ipython_folder)) and time.monotonic() < deadline:
        for process in left:
            with contextlib.suppress(psutil.Error):
                process.kill()
        await asyncio.sleep(0.02)


def _leftovers(ipython_folder: str) -> list[psutil.Process]:
    left = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get('IPYTHONDIR') == ipython_folder:
                left.append(process)
    return left
