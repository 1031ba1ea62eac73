"""What rclpy was doing when it raised, by its frames: sending an object, or calling a service."""

import traceback
from typing import Any

from rclpy.client import Client
from rclpy.publisher import Publisher
from rclpy.service import Service

from my_robot_basics.exchange.wrong_fields import wrong_field


def unpublished_field(error: BaseException) -> tuple[str, str] | None:
    """Return the field that could not be serialized, and its type; None for other errors."""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        message, type_ = _sent(frame.f_locals)
        if type_ is not None and isinstance(message, type_):
            path, _, type_name = wrong_field(message, type_)
            return (path, type_name) if path else None
    return None


def _sent(names: dict[str, Any]) -> tuple[Any, Any]:
    """Return what one of rclpy's functions with these local variables sends, and its type."""
    match names.get('self'):
        case Publisher():
            return names.get('msg'), names['self'].msg_type
        case Service():
            return names.get('response'), names['self'].srv_type.Response
        case Client():
            return names.get('request'), names['self'].srv_type.Request
    return None, None


def service_name(error: BaseException) -> str:
    """Return the service whose callback raised, from the frame of rclpy that called it; or ''."""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        service = frame.f_locals.get('srv')
        if frame.f_code.co_name == '_execute' and isinstance(service, Service):
            return service.service_name
    return ''
