"""Keep rooms within their memory if there are no cgroups, by checking twice a second."""

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
    """Keep all processes of each room within its memory limit; kill the largest first.

    `pids` returns the processes of all rooms. The IDs of those that were killed are added to
    `killed`. It runs until it is cancelled.
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
    """Return a process's memory in bytes without mapped files; processes may share some of it."""
    status = Path(f'/proc/{pid}/status').read_text(encoding='utf-8', errors='replace')
    return 1_024 * sum(map(int, _OWN.findall(status)))
