"""One ROS domain per kernel: the first free one of this machine, until the kernel's end.

Imports neither rclpy nor anything else that is slow.
"""

import errno
import os
import socket
import weakref
from dataclasses import dataclass

from my_robot_basics.session.errors import NoFreeDomain

FIRST, LAST = 1, 101
"""DDS's ports of higher domains are in Linux's range of ephemeral ports; 0 is ROS's default."""


@dataclass(frozen=True, eq=False)
class Claim:
    """A domain reserved for this process until `release()` or the process's end."""

    domain_id: int
    """ROS domain ID, 1 to 101."""

    _holder: socket.socket

    def release(self) -> None:
        """Give the domain back; a second call does nothing."""
        self._holder.close()


def claim() -> Claim:
    """Reserve the first free ROS domain; raises NoFreeDomain if all are taken.

    The claim is a bound abstract Unix socket: it needs no file, binding is atomic across all
    users of the machine (of the network namespace, to be exact), and Linux closes it with the
    process, however that ends. Processes that the holder starts do not keep it.
    """
    for domain_id in range(FIRST, LAST + 1):
        if holder := bind_abstract_socket(f'my_robot_basics.domain.{domain_id}'):
            return Claim(domain_id, holder)
    raise NoFreeDomain(
        f'all {LAST - FIRST + 1} ROS domains of this machine are taken, one by each running '
        'lesson: shut down kernels that you no longer need, then restart this one'
    )


def bind_abstract_socket(name: str) -> socket.socket | None:
    """Bind an abstract Unix socket to a name, or return None if the name is taken.

    The name is taken until the socket is closed or this process ends.
    """
    # not inherited through exec: Python's sockets are close-on-exec
    holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        holder.bind(f'\0{name}')
    except OSError as error:
        holder.close()
        if error.errno != errno.EADDRINUSE:
            raise
        return None
    _held.add(holder)
    return holder


_held: weakref.WeakSet[socket.socket] = weakref.WeakSet()


def _close_held_sockets() -> None:
    for holder in list(_held):
        holder.close()


# a forked child uses its parent's domain, but must not keep it reserved after the parent's end
os.register_at_fork(after_in_child=_close_held_sockets)
