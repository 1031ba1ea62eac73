"""Process 1 of a student's room: it starts the server, and relays the hub's connections to it.

`python room.py DESCRIPTOR PORT COMMAND...`. The descriptor is a listening socket that the spawner
opened outside: connections to it are relayed to 127.0.0.1:PORT in the room, where the server is.
"""

import asyncio
import ctypes
import os
import signal
import socket
import subprocess
import sys

CHUNK_BYTES = 65_536
STOP_GRACE_SEC = 10.0
"""How long a server that was told to end may take to end its kernels."""
_PR_SET_DUMPABLE = 4


def refuse_tracing() -> None:
    """Keep other processes of the room, which have the same user, from taking a descriptor here.

    The listening socket belongs to the network outside: code that has it can disconnect it, and
    connect it to anything there. Raises RuntimeError.
    """
    if ctypes.CDLL(None).prctl(_PR_SET_DUMPABLE, 0, 0, 0, 0) != 0:
        raise RuntimeError('process 1 of a room could not be made one that no other may trace')


async def copy_stream(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Copy data until one of the two sides is closed."""
    try:
        while chunk := await reader.read(CHUNK_BYTES):
            writer.write(chunk)
            await writer.drain()
        writer.write_eof()
    except OSError:
        writer.close()


async def relay(listening: socket.socket, port: int) -> asyncio.Server:
    """Relay each connection to 127.0.0.1:port, in both directions; return the asyncio server."""

    async def join(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            inside = await asyncio.open_connection('127.0.0.1', port)
        except OSError:  # the server is not up yet, or gone: the hub tries again
            writer.close()
            return
        await asyncio.gather(copy_stream(reader, inside[1]), copy_stream(inside[0], writer))
        inside[1].close()
        writer.close()

    return await asyncio.start_server(join, sock=listening)


def reap_processes(server: subprocess.Popen[bytes]) -> int | None:
    """Reap ended processes, orphans too; return the server's exit code when it has ended."""
    while True:
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return server.returncode
        if pid == 0:
            return server.returncode
        if pid == server.pid:
            server.returncode = os.waitstatus_to_exitcode(status)


async def run(descriptor: int, port: int, command: list[str]) -> int:
    """Run the server until it ends or this process is told to end; return its exit code."""
    loop = asyncio.get_running_loop()
    ended: asyncio.Future[int] = loop.create_future()
    told = asyncio.Event()
    # before the server starts: from then on a signal to end may arrive
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, told.set)
    # only process 1 keeps the listening socket: student code does not need it
    refuse_tracing()
    os.set_inheritable(descriptor, False)
    server = subprocess.Popen(command, start_new_session=True)

    def look() -> None:
        code = reap_processes(server)
        if code is not None and not ended.done():
            ended.set_result(code)

    loop.add_signal_handler(signal.SIGCHLD, look)
    look()
    relaying = await relay(socket.socket(fileno=descriptor), port)
    await asyncio.wait(
        [ended, asyncio.ensure_future(told.wait())], return_when=asyncio.FIRST_COMPLETED
    )
    if not ended.done():
        server.terminate()
        await asyncio.wait([ended], timeout=STOP_GRACE_SEC)
    relaying.close()  # do not wait for browsers, which stay connected until they are cut off
    return ended.result() if ended.done() else 1


if __name__ == '__main__':
    sys.exit(asyncio.run(run(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:])))
