"""The sockets between the grader and one kernel."""

from typing import cast

import zmq.asyncio
from jupyter_client import AsyncKernelClient, AsyncKernelManager
from my_robot_basics.validate.connecting import wait_for_sockets, wait_for_welcome
from my_robot_basics.validate.limits import MAX_MESSAGE_BYTES, MAX_MESSAGES_WAITING
from my_robot_basics.validate.messages import Messages, unpacked

from grader.common.errors import RoomFailure


class KernelConnection:
    """Prepared before the kernel starts; connect() when it was started, close() at the end."""

    def __init__(self) -> None:
        """Make the context of all its sockets, with limits on what a kernel may send."""
        self.context = zmq.asyncio.Context()
        self.context.setsockopt(zmq.MAXMSGSIZE, MAX_MESSAGE_BYTES)
        self.context.setsockopt(zmq.RCVHWM, MAX_MESSAGES_WAITING)
        self._client: AsyncKernelClient | None = None
        self._messages: Messages | None = None
        self._monitors: list[zmq.asyncio.Socket] = []

    async def connect(self, manager: AsyncKernelManager) -> None:
        """Wait until the kernel's sockets are there, and until it knows that we listen.

        Raises RoomFailure where its process ends instead.
        """

        async def expect_alive() -> None:
            if not await manager.is_alive():
                raise RoomFailure('its process ended')

        await wait_for_sockets(manager, expect_alive)
        self._client = client = manager.client(context=self.context)
        client.session.unpack = unpacked
        client.start_channels(hb=False)
        self._messages = Messages(client)
        for channel in (client.iopub_channel, client.shell_channel):
            self._monitors.append(channel.socket.get_monitor_socket(zmq.EVENT_DISCONNECTED))
        await wait_for_welcome(client, expect_alive)

    @property
    def client(self) -> AsyncKernelClient:
        """What sends requests; only once it is connected."""
        assert self._client is not None
        return self._client

    @property
    def messages(self) -> Messages:
        """What the kernel sends; only once it is connected."""
        assert self._messages is not None
        return self._messages

    @property
    def is_cut_off(self) -> bool:
        """Whether a connection has ended: by the kernel's end, by what it did, or by a message.

        ZMQ ends one whose message is larger than MAX_MESSAGE_BYTES; nothing comes on it any more.
        """
        return any(cast(int, monitor.get(zmq.EVENTS)) & zmq.POLLIN for monitor in self._monitors)

    def close(self) -> None:
        """Close all sockets, and drop what was not sent."""
        if self._client is not None:
            self._client.stop_channels()
        self.context.destroy(linger=0)
