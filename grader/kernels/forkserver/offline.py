"""Keep a kernel off the network: it listens only on sockets in its own folder.

ipykernel receives the output of processes forked in a kernel over TCP, whatever transport the
kernel uses, and reads whatever is sent there. The two rooms share one network.
"""

import json
import sys
from typing import Any


def keep_off_the_network() -> None:
    """Receive the output of forked processes over a Unix socket beside the kernel's own."""
    from ipykernel.iostream import IOPubThread

    # methods of a library, replaced on purpose
    IOPubThread._setup_pipe_in = _listen  # type: ignore[method-assign]
    IOPubThread._setup_pipe_out = _connect  # type: ignore[method-assign]


def _listen(self: Any) -> None:
    """Do what ipykernel's own method does, with another address."""
    import os

    import zmq
    from zmq.eventloop.zmqstream import ZMQStream

    self._pipe_uuid = os.urandom(16)
    pipe = self.socket.context.socket(zmq.PULL)
    pipe.linger = 0
    pipe.bind(_address())
    self._pipe_in = ZMQStream(pipe, self.io_loop)
    self._pipe_in.on_recv(self._handle_pipe_msg)


def _connect(self: Any) -> tuple:
    """Return a context and a socket for a forked process, which can't use its parent's."""
    import zmq

    context = zmq.Context()
    pipe = context.socket(zmq.PUSH)
    pipe.linger = 3_000
    pipe.connect(_address())
    return context, pipe


def _address() -> str:
    with open(sys.argv[sys.argv.index('-f') + 1], encoding='utf-8') as connection:
        return f'ipc://{json.load(connection)["ip"]}-forked'
