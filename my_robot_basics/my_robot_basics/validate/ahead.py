"""Open the rooms of the next exercise while this one is looked at: to start kernels takes long."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Self

from my_robot_basics.validate.rooms import Rooms, Say


class Ahead:
    """Gives rooms out; `async with` waits at its end until all that were opened are closed."""

    def __init__(self, files: Sequence[Path]) -> None:
        """Open rooms in which the student's kernel finds copies of `files`."""
        self._files = files
        self._next: asyncio.Task[Rooms] | None = None
        self._closing: list[asyncio.Task[None]] = []

    async def __aenter__(self) -> Self:
        """Open nothing yet."""
        return self

    async def __aexit__(self, *_: object) -> None:
        """Close what is open."""
        if self._next is not None:
            self._next.cancel()
            self._closing.append(asyncio.create_task(_close(self._next)))
        await asyncio.gather(*self._closing)

    @asynccontextmanager
    async def rooms(self, *, say: Say, more: bool) -> AsyncIterator[Rooms]:
        """Give out rooms, and begin to open others if there will be `more` to do.

        They are closed in the background. Raises RoomFailure.
        """
        opening = self._next or asyncio.create_task(self._open())
        self._next = None
        say('starting two kernels')
        try:
            rooms = await opening
            rooms.say = say
            self._next = asyncio.create_task(self._open()) if more else None
            yield rooms
        finally:
            opening.cancel()  # where it is not done: we are being cancelled ourselves
            self._closing.append(asyncio.create_task(_close(opening)))

    async def _open(self) -> Rooms:
        return await Rooms(files=self._files).__aenter__()


async def _close(opening: asyncio.Task[Rooms]) -> None:
    """Close rooms as soon as they are open; those that did not open have closed themselves."""
    await asyncio.wait([opening])
    if not opening.cancelled() and opening.exception() is None:
        await opening.result().__aexit__()
