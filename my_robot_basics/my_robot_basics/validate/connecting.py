"""Wait until a kernel that was started can be asked to run a cell, and its outputs are received.

jupyter_client's wait_for_ready asks and flushes by fractions of a second; a kernel says itself
when it has taken a subscription, and what it is sent earlier waits in its queue.
"""

import asyncio
import contextlib
import queue
from collections.abc import Awaitable, Callable
from pathlib import Path

from jupyter_client import AsyncKernelClient, AsyncKernelManager

ExpectAlive = Callable[[], Awaitable[None]]
"""Raises RoomFailure where the kernel's process has ended."""


async def wait_for_sockets(manager: AsyncKernelManager, expect_alive: ExpectAlive) -> None:
    """Wait until a kernel with transport 'ipc' has made its sockets."""
    while not Path(f'{manager.ip}-{manager.iopub_port}').exists():
        await expect_alive()
        await asyncio.sleep(0.01)


async def wait_for_welcome(client: AsyncKernelClient, expect_alive: ExpectAlive) -> None:
    """Wait until the kernel says that it has taken the client's subscription to its outputs."""
    kind = None
    while kind != 'iopub_welcome':
        await expect_alive()
        with contextlib.suppress(queue.Empty):
            kind = (await client.get_iopub_msg(timeout=0.5))['msg_type']
