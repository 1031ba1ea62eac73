"""Subscriptions of rmw, the layer below rclpy, by ctypes: to DDS topics that rclpy cannot name.

rclpy puts a slash before each topic name, and needs the message's class, whose import may take as
long as that of rclpy. Here a topic has its name in DDS, and messages are serialized bytes.
"""

import ctypes

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node


class LatchedSubscription:
    """Takes each message of a latched DDS topic once; do not destroy the node before `close`.

    Raises RuntimeError if rmw refuses the subscription.
    """

    def __init__(
        self, node: Node, topic_name: str, *, package: str, message_name: str, kind: str = 'msg'
    ) -> None:
        """`kind` of the interface: 'msg', or 'srv' for a request or response."""
        self._rmw = _functions()
        self._node = self._rmw.rcl_node_get_rmw_handle(node.handle.pointer)
        self._bytes = _Bytes()
        allocator = self._rmw.rcutils_get_default_allocator()
        self._rmw.rcutils_uint8_array_init(self._bytes, 0, allocator)
        type_support = _type_support(package, kind, message_name)
        self._subscription = self._rmw.rmw_create_subscription(
            self._node, type_support, topic_name.encode(), _LATCHED, _Options()
        )
        if not self._subscription:
            self._rmw.rcutils_uint8_array_fini(self._bytes)
            raise RuntimeError(f'rmw does not subscribe to the DDS topic {topic_name}')

    def close(self) -> None:
        """Destroy the subscription."""
        self._rmw.rmw_destroy_subscription(self._node, self._subscription)
        self._rmw.rcutils_uint8_array_fini(self._bytes)

    def take(self) -> bytes | None:
        """The next message, serialized, or None if there is none at present."""
        is_taken = ctypes.c_bool()
        status = self._rmw.rmw_take_serialized_message(
            self._subscription, self._bytes, is_taken, None
        )
        if status or not is_taken.value:
            return None
        return ctypes.string_at(self._bytes.buffer, self._bytes.length)


class _Qos(ctypes.Structure):
    """`rmw_qos_profile_t`: policies by number, times in seconds and nanoseconds (0: default)."""

    _fields_ = (
        ('history', ctypes.c_int),
        ('depth', ctypes.c_size_t),
        ('reliability', ctypes.c_int),
        ('durability', ctypes.c_int),
        ('deadline', ctypes.c_uint64 * 2),
        ('lifespan', ctypes.c_uint64 * 2),
        ('liveliness', ctypes.c_int),
        ('lease', ctypes.c_uint64 * 2),
        ('avoid_ros_namespace_conventions', ctypes.c_bool),
    )


_KEEP_ALL, _RELIABLE, _TRANSIENT_LOCAL, _AUTOMATIC = 2, 1, 1, 1
_LATCHED = _Qos(
    history=_KEEP_ALL,
    reliability=_RELIABLE,
    durability=_TRANSIENT_LOCAL,
    liveliness=_AUTOMATIC,
    avoid_ros_namespace_conventions=True,
)


class _Options(ctypes.Structure):
    """`rmw_subscription_options_t`; zeros are its defaults."""

    _fields_ = (
        ('specific', ctypes.c_void_p),
        ('ignore_local_publications', ctypes.c_bool),
        ('unique_network_flow', ctypes.c_int),
        ('content_filter', ctypes.c_void_p),
    )


class _Allocator(ctypes.Structure):
    """`rcutils_allocator_t`."""

    _fields_ = tuple((f'pointer{n}', ctypes.c_void_p) for n in range(5))


class _Bytes(ctypes.Structure):
    """`rmw_serialized_message_t`."""

    _fields_ = (
        ('buffer', ctypes.c_void_p),
        ('length', ctypes.c_size_t),
        ('capacity', ctypes.c_size_t),
        ('allocator', _Allocator),
    )


def _functions() -> ctypes.CDLL:
    """The functions of the same rmw and rcl that rclpy uses."""
    library = ctypes.CDLL(rclpy_implementation.__file__)
    pointer, by_reference = ctypes.c_void_p, ctypes.POINTER
    library.rcl_node_get_rmw_handle.restype = pointer
    library.rcl_node_get_rmw_handle.argtypes = (pointer,)
    library.rcutils_get_default_allocator.restype = _Allocator
    library.rcutils_uint8_array_init.argtypes = (
        *(by_reference(_Bytes), ctypes.c_size_t, by_reference(_Allocator)),
    )
    library.rcutils_uint8_array_fini.argtypes = (by_reference(_Bytes),)
    library.rmw_create_subscription.restype = pointer
    library.rmw_create_subscription.argtypes = (
        *(pointer, pointer, ctypes.c_char_p, by_reference(_Qos), by_reference(_Options)),
    )
    library.rmw_destroy_subscription.argtypes = (pointer, pointer)
    library.rmw_take_serialized_message.argtypes = (
        *(pointer, by_reference(_Bytes), by_reference(ctypes.c_bool), pointer),
    )
    return library


def _type_support(package: str, kind: str, name: str) -> int:
    library = ctypes.CDLL(f'lib{package}__rosidl_typesupport_c.so')
    prefix = 'rosidl_typesupport_c__get_message_type_support_handle'
    get = library[f'{prefix}__{package}__{kind}__{name}']
    get.restype = ctypes.c_void_p
    return get()
