"""A process that grades: tasks come in over a socket, results go back, until it is closed.

`grader.workers.begin_worker` is what runs in it.
"""

import asyncio
import importlib
import os
import signal
import socket
import struct

from grader.common.logs import log_visibly
from grader.judging.task import run_packed
from grader.kernels.isolation import look_ahead
from grader.sandbox.limits import MAX_TASK_BYTES

BEAT_SEC = 5.0
"""How often a worker says that it is alive, whatever it is at."""
DEAD_SEC = 180
"""A worker that does nothing for so long ends, even if the run that would end it is gone."""
_HEAD = struct.Struct('>QQ')
"""The number of a task, and how many bytes of JSON follow."""
BEAT = 0
"""Stands for the number of a task: nothing follows."""


async def receive(reader: asyncio.StreamReader, *, most: int) -> tuple[int, str] | None:
    """Wait for a numbered text of at most `most` bytes.

    None where the other end is gone, or claims to have more to say.
    """
    try:
        number, size = _HEAD.unpack(await reader.readexactly(_HEAD.size))
        if size > most:
            return None
        return number, (await reader.readexactly(size)).decode('ascii')
    except (asyncio.IncompleteReadError, ConnectionError):
        return None


async def send(writer: asyncio.StreamWriter, number: int, text: str = '') -> None:
    """Send a numbered text. Raises ConnectionError where the other end is gone."""
    writer.write(_HEAD.pack(number, len(text)) + text.encode('ascii'))
    await writer.drain()


async def serve(connection: socket.socket) -> None:
    """Grade whatever comes as soon as it comes; end everything once the other end is gone."""
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
    """Serve the socket of that number; nothing that is started from here inherits it."""
    log_visibly()
    connection = socket.socket(fileno=int(handle))
    os.set_inheritable(connection.fileno(), False)
    asyncio.run(serve(connection))


def prepare() -> None:
    """Prepare what the first task needs; processes do it side by side."""
    look_ahead()
    importlib.import_module('grader.judging.execute')
