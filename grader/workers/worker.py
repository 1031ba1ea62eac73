"""A process that grades: it receives tasks over a socket and sends results until it is closed.

`grader.workers.begin_worker` is its main program.
"""

import asyncio
import importlib
import os
import signal
import socket
import struct

from grader.common.logs import log_visibly
from grader.judging.task import run_packed
from grader.kernels.isolation import try_in_background
from grader.sandbox.limits import MAX_TASK_BYTES

BEAT_SEC = 5.0
"""Interval at which a worker sends a sign of life, whatever it is doing."""
DEAD_SEC = 180
"""If its event loop is blocked for so long, a worker ends, even if its parent process is gone."""
_HEAD = struct.Struct('>QQ')
"""The number of a task, and how many bytes of JSON follow."""
BEAT = 0
"""Sent instead of the number of a task, as a sign of life: no JSON follows."""


async def receive(reader: asyncio.StreamReader, *, most: int) -> tuple[int, str] | None:
    """Wait for a numbered text of at most `most` bytes.

    Returns None if the other end is gone, or announces more bytes.
    """
    try:
        number, size = _HEAD.unpack(await reader.readexactly(_HEAD.size))
        if size > most:
            return None
        return number, (await reader.readexactly(size)).decode('ascii')
    except (asyncio.IncompleteReadError, ConnectionError):
        return None


async def send(writer: asyncio.StreamWriter, number: int, text: str = '') -> None:
    """Send a numbered text. Raises ConnectionError if the other end is gone."""
    writer.write(_HEAD.pack(number, len(text)) + text.encode('ascii'))
    await writer.drain()


async def serve(connection: socket.socket) -> None:
    """Grade each task as soon as it arrives; end everything when the other end is gone."""
    reader, writer = await asyncio.open_connection(sock=connection)
    under_way = {asyncio.create_task(_beat(writer))}
    try:
        while asked := await receive(reader, most=MAX_TASK_BYTES):
            task = asyncio.create_task(_answer(writer, *asked))
            under_way.add(task)
            task.add_done_callback(under_way.discard)
    finally:
        left = list(under_way)
        for task in left:
            task.cancel()
        await asyncio.gather(*left, return_exceptions=True)
        writer.close()


async def _answer(writer: asyncio.StreamWriter, number: int, text: str) -> None:
    await send(writer, number, await run_packed(text))


async def _beat(writer: asyncio.StreamWriter) -> None:
    while True:
        signal.alarm(DEAD_SEC)  # SIGALRM ends the process even if its loop is blocked
        await send(writer, BEAT)
        await asyncio.sleep(BEAT_SEC)


def main(handle: str) -> None:
    """Serve the socket with that file descriptor; processes started from here don't inherit it."""
    log_visibly()
    connection = socket.socket(fileno=int(handle))
    os.set_inheritable(connection.fileno(), False)
    asyncio.run(serve(connection))


def prepare() -> None:
    """Prepare what the first task needs, most of it in other processes or threads."""
    try_in_background()
    importlib.import_module('grader.judging.execute')
