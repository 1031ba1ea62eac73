"""Run several awaitables concurrently."""

import asyncio
from collections.abc import Awaitable
from typing import TypeVar

T = TypeVar('T')


async def gather_or_cancel(*work: Awaitable[T]) -> list[T]:
    """Wait for all of them; if one fails, cancel the others and wait for their end."""
    tasks = [asyncio.ensure_future(each) for each in work]
    try:
        return await asyncio.gather(*tasks)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
