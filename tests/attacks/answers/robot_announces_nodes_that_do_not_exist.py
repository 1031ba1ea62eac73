"""Runs at 1 Hz, and announces names of many nodes that do not exist, which DDS keeps for all."""

import ctypes
import os
import struct
import threading

from my_robot_basics.graph import rmw

AT_ONCE, MESSAGES = 50_000, 20


def announcement():
    parts = [b'\0\1\0\0' + os.urandom(16) + struct.pack('<I', AT_ONCE)]
    for number in range(AT_ONCE):
        name = b'n%010d\0' % number
        parts.append(struct.pack('<I4sI12sII', 2, b'/', len(name), name, 0, 0))
    return b''.join(parts)


def announce(node):
    library, pointer = rmw._functions(), ctypes.c_void_p
    make, send = library.rmw_create_publisher, library.rmw_publish_serialized_message
    make.restype, make.argtypes = pointer, (pointer, pointer, ctypes.c_char_p, pointer, pointer)
    send.argtypes = (pointer, pointer, pointer)
    qos = rmw._Qos(1, MESSAGES, 1, 1, liveliness=1, avoid_ros_namespace_conventions=True)
    publisher = make(
        library.rcl_node_get_rmw_handle(node.handle.pointer),
        rmw._type_support('rmw_dds_common', 'msg', 'ParticipantEntitiesInfo'),
        b'ros_discovery_info',
        ctypes.byref(qos),
        ctypes.byref(rmw._Options()),
    )
    for _ in range(MESSAGES):
        said = announcement()
        kept = ctypes.create_string_buffer(said, len(said))
        place = ctypes.cast(kept, pointer).value
        message = rmw._Bytes(place, len(said), len(said), library.rcutils_get_default_allocator())
        send(publisher, ctypes.byref(message), None)


class KinematicsPublisher(KinematicsPublisher):
    def __init__(self):
        super().__init__()
        threading.Thread(target=announce, args=(self,), daemon=True).start()
