"""What rclpy expects when it raises a TypeError without text: a request, a goal, or feedback."""

import traceback
from typing import Any

from rclpy.action import ActionClient
from rclpy.action.server import ServerGoalHandle
from rclpy.client import Client

MOST_FIELDS = 3


def how_to_make(error: BaseException) -> str:
    """Return how to make the expected object: 'SolveIK.Request(target=…)'; '' for other errors."""
    if type(error) is not TypeError or error.args or error.__traceback__ is None:
        return ''
    *_, (frame, _) = traceback.walk_tb(error.__traceback__)
    match frame.f_locals.get('self'), frame.f_code.co_name:
        case Client() as client, 'call' | 'call_async':
            return _call(client.srv_type, 'Request')
        case ActionClient() as client, 'send_goal' | 'send_goal_async':
            return _call(client._action_type, 'Goal')
        case ServerGoalHandle() as handle, 'publish_feedback':
            return _call(handle._action_server.action_type, 'Feedback')
    return ''


def _call(type_: Any, part: str) -> str:
    """Return the call that makes a part of a service or action type, with its first fields."""
    fields = list(getattr(type_, part).get_fields_and_field_types())[:MOST_FIELDS]
    return f'{type_.__name__}.{part}({", ".join(f"{field}=…" for field in fields)})'
