"""Fills the kernel's memory: with semaphores, message queues, pipes, and sockets that nobody reads."""

import ctypes
import os
import socket
import time

call = ctypes.CDLL(None, use_errno=True)
kept = []


def semaphores():
    return call.semget(0, 32_000, 0o1600) >= 0


def messages():
    queue = call.msgget(0, 0o1600)
    text = ctypes.create_string_buffer(b'\1' * 8_000)
    return queue >= 0 and call.msgsnd(queue, text, 7_900, 0o4000) == 0


def pipes():
    kept.append(os.pipe())
    os.set_blocking(kept[-1][1], False)
    return os.write(kept[-1][1], bytes(65_536))


def sockets():
    kept.append(pair := socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM))
    pair[0].setblocking(False)
    pair[0].setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 2**30)
    return pair[0].send(bytes(100_000))


def terminals():
    kept.append(os.openpty())
    return True


for _ in range(6):
    os.fork()
for fill in semaphores, messages, pipes, sockets, terminals:
    for _ in range(400):
        try:
            if not fill():
                break
        except OSError:
            break
time.sleep(8)
