"""Wait on an event loop for a file that another process writes to."""

import asyncio


async def readable(file: int) -> None:
    """Wait until there is something to read, or the other end was closed."""
    loop, ready = asyncio.get_running_loop(), asyncio.Event()
    loop.add_reader(file, ready.set)
    try:
        await ready.wait()
    finally:
        loop.remove_reader(file)
