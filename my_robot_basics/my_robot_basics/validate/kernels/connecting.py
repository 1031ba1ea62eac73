"""Wait until a new kernel can run a cell and its outputs are received.

jupyter_client's wait_for_ready polls, which takes fractions of a second. But a kernel announces
itself that it has accepted a subscription, and earlier requests wait in its queue.
"""

import asyncio
import contextlib
import queue
from collections.abc import Awaitable, Callable
from pathlib import Path

from jupyter_client import AsyncKernelClient, AsyncKernelManager

ExpectAlive = Callable[[], Awaitable[None]]
"""Raises RoomFailure if the kernel's process has ended."""


async def wait_for_sockets(manager: AsyncKernelManager, expect_alive: ExpectAlive) -> None:
    """Wait until a kernel with transport 'ipc' has created its sockets."""
    while not Path(f'{manager.ip}-{manager.iopub_port}').exists():
        await expect_alive()
        await asyncio.sleep(0.01)


async def wait_for_welcome(client: AsyncKernelClient, expect_alive: ExpectAlive) -> None:
    """Wait until the kernel confirms the client's subscription to its outputs."""
    kind = None
    while kind != 'iopub_welcome':
        await expect_alive()
        with contextlib.suppress(queue.Empty):
            kind = (await client.get_iopub_msg(timeout=0.5))['msg_type']
