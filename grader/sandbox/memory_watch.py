"""Keeps rooms within their memory where there are no cgroups: by looking twice a second."""

import asyncio
import contextlib
import os
import re
import signal
from collections import defaultdict
from collections.abc import Callable, Iterable
from pathlib import Path

from grader.sandbox.limits import ROOM_MEMORY_BYTES

WATCH_EVERY_SEC = 0.5
_OWN = re.compile(r'^Rss(?:Anon|Shmem):\s+(\d+) kB$', re.MULTILINE)


async def watch_memory(pids: Callable[[], Iterable[int]], killed: set[int]) -> None:
    """Keep all processes of each room within its memory: the largest ends first.

    `pids` returns the processes of all rooms; those that were ended for it are added to
    `killed`. It goes on until it is cancelled.
    """
    while True:
        await asyncio.sleep(WATCH_EVERY_SEC)
        rooms: dict[int, dict[int, int]] = defaultdict(dict)
        for pid in pids():
            with contextlib.suppress(OSError):  # it has ended meanwhile
                rooms[os.stat(f'/proc/{pid}/ns/pid').st_ino][pid] = _own_memory(pid)
        for used in rooms.values():
            while sum(used.values()) > ROOM_MEMORY_BYTES:
                largest = max(used, key=lambda pid: used[pid])
                del used[largest]
                killed.add(largest)
                with contextlib.suppress(ProcessLookupError):
                    os.kill(largest, signal.SIGKILL)


def _own_memory(pid: int) -> int:
    """Return the bytes that a process shares with no file; with other processes, perhaps."""
    status = Path(f'/proc/{pid}/status').read_text(encoding='utf-8', errors='replace')
    return 1_024 * sum(map(int, _OWN.findall(status)))
