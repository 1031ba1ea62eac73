"""Hints for a name that does not exist: another spelling, or where to define an attribute."""

import difflib
import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from my_robot_basics.feedback.rclpy_names import CLASSES

METHODS = (
    *('create_publisher', 'create_subscription', 'create_timer', 'create_client'),
    *('create_service', 'get_logger', 'declare_parameter', 'get_parameter', 'set_parameters'),
    *('add_on_set_parameters_callback', 'destroy_node', 'call_async', 'wait_for_service'),
    *('service_is_ready', 'wait_for_server', 'send_goal_async', 'add_done_callback'),
    *('get_result_async', 'cancel_goal_async', 'publish_feedback', 'is_cancel_requested'),
    *('spin_once', 'spin_until_future_complete', 'add_node', 'remove_node', 'create_node'),
)
"""Methods and functions of rclpy that the lessons use, and whose names have several words."""
TYPES = (
    *('Node', 'JointState', 'Point', 'PointStamped', 'Header', 'Int32', 'String', 'Bool', 'Time'),
    *('SolveIK', 'MoveArm', 'SetBool', 'Trigger', 'GoalStatus', 'Duration', 'Parameter'),
    *('ActionClient', 'ActionServer', 'GoalResponse', 'CancelResponse', 'QoSProfile'),
    *('DurabilityPolicy', 'ReliabilityPolicy', 'ExternalShutdownException'),
    *('MultiThreadedExecutor', 'SingleThreadedExecutor', 'ReentrantCallbackGroup'),
    *('MutuallyExclusiveCallbackGroup', 'ParameterDescriptor', 'SetParametersResult'),
)
"""Classes, messages, services and actions that the lessons import."""
_OTHER_WORDS = {'createsubscriber': 'create_subscription', 'createserver': 'create_service'}
"""Names with another word in them, without their underscores."""
_ALIKE = 0.88
"""How alike two names are, at least, if one is a misspelling of the other."""
_UNKNOWN = re.compile(r"cannot import name '(\w+)' from|name '([A-Z]\w+)' is not defined")
"""A variable, too, may be undefined: a class has a capital letter."""
_MISSING = re.compile(r"has no attribute '(\w+)'")
_MAY_BE_OWN = re.compile(rf"'(?!(?:NoneType|{CLASSES})')[A-Z]\w*' object has no attribute")
"""What Python says of an object whose class may be a student's own, by its capital letter."""


def hint_for_misspelt(said: str) -> str:
    """Return what to write in place of a misspelt name of a class, message, service or action."""
    found = _UNKNOWN.search(said)
    name = (found[1] or found[2]) if found else ''
    meant = _spell(name, TYPES)
    return f', so write {meant!r} in its place' if meant else ''


def hint_for_missing(said: str) -> str:
    """Return what to write in place of an attribute that is missing, or where to define it."""
    found = _MISSING.search(said)
    if found is None:
        return ''
    if method := _spell(found[1], METHODS, _OTHER_WORDS):
        return f', so write {method!r} in its place'
    if _MAY_BE_OWN.search(said):
        return (
            ', so check its spelling; in a class of your own, define it before it is used: as '
            'self.… in __init__, or as a method, whose def begins as far to the right as that of '
            '__init__'
        )
    return ''


def _spell(
    name: str, known: Sequence[str], others: Mapping[str, str] = MappingProxyType({})
) -> str:
    """Return which of the known names is meant; '' for none, and for itself."""
    by_letters = {each.replace('_', '').casefold(): each for each in known} | dict(others)
    plain = name.replace('_', '').casefold()
    alike = difflib.get_close_matches(plain, by_letters, n=1, cutoff=_ALIKE)
    return by_letters[alike[0]] if alike and name not in known else ''
