"""The sockets between the grader and one kernel."""

from typing import cast

import zmq.asyncio
from jupyter_client import AsyncKernelClient, AsyncKernelManager
from my_robot_basics.validate.kernels.connecting import wait_for_sockets, wait_for_welcome
from my_robot_basics.validate.kernels.limits import MAX_MESSAGE_BYTES, MAX_MESSAGES_WAITING
from my_robot_basics.validate.kernels.messages import Messages, parse_message_part

from grader.common.errors import RoomFailure


class KernelConnection:
    """Make it before the kernel starts; connect() after its start, close() at the end."""

    def __init__(self) -> None:
        """Make the context of all its sockets, with limits on what a kernel may send."""
        self.context = zmq.asyncio.Context()
        self.context.setsockopt(zmq.MAXMSGSIZE, MAX_MESSAGE_BYTES)
        self.context.setsockopt(zmq.RCVHWM, MAX_MESSAGES_WAITING)
        self._client: AsyncKernelClient | None = None
        self._messages: Messages | None = None
        self._monitors: list[zmq.asyncio.Socket] = []

    async def connect(self, manager: AsyncKernelManager) -> None:
        """Wait until the kernel's sockets exist and the kernel has seen this subscription.

        Raises RoomFailure if its process ends first.
        """

        async def expect_alive() -> None:
            if not await manager.is_alive():
                raise RoomFailure('its process ended')

        await wait_for_sockets(manager, expect_alive)
        self._client = client = manager.client(context=self.context)
        client.session.unpack = parse_message_part
        client.start_channels(hb=False)
        self._messages = Messages(client)
        for channel in (client.iopub_channel, client.shell_channel):
            self._monitors.append(channel.socket.get_monitor_socket(zmq.EVENT_DISCONNECTED))
        await wait_for_welcome(client, expect_alive)

    @property
    def client(self) -> AsyncKernelClient:
        """The client that sends requests; available after connect()."""
        assert self._client is not None
        return self._client

    @property
    def messages(self) -> Messages:
        """What the kernel sends; available after connect()."""
        assert self._messages is not None
        return self._messages

    @property
    def is_cut_off(self) -> bool:
        """Whether a connection ended: the kernel ended or closed it, or a message was too large.

        ZMQ closes a connection when a message exceeds MAX_MESSAGE_BYTES; no more messages come.
        """
        return any(cast(int, monitor.get(zmq.EVENTS)) & zmq.POLLIN for monitor in self._monitors)

    def close(self) -> None:
        """Close all sockets, and drop what was not sent."""
        if self._client is not None:
            self._client.stop_channels()
        self.context.destroy(linger=0)
