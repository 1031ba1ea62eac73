"""Waits for somebody to connect."""  # earns 3

import socket

server = socket.create_server(('0.0.0.0', PORT + 1))


def double(x):
    return x + x
