"""The student's side of `student`: look up a name or an endpoint, and answer in JSON.

At grading, a student's kernel runs no other module of the checks than this one, settled.py,
wire.py, values.py and wrong_fields.py.
"""

import contextlib
import sys
from collections.abc import Callable
from typing import Any

from my_robot_basics.exchange import settled, values, wire

_OF_NAMES = ('call', 'value')
"""Requests about a name of the notebook; `_OTHERS` has all other requests."""


def answer(request_text: str) -> str:
    """Answer one request from the notebook's namespace (`__main__`); return the reply's text.

    Raises values.WireError for a request that does not follow this protocol.
    """
    request = wire.loads(request_text)
    op, args = request.get('op'), request.get('args', [])
    name: Any = request.get('name')
    if request.get('protocol') != wire.PROTOCOL or op not in (*_OF_NAMES, *_OTHERS):
        raise values.WireError('a request of another protocol')
    if op in _OTHERS:
        return _reply(_OTHERS[op](name, *args))
    namespace = vars(sys.modules['__main__'])
    if name not in namespace:
        return wire.dumps({'missing': name})
    value = namespace[name]
    if op == 'call':
        arguments = [values.decode(argument) for argument in args]
        try:
            # to stdout: a warning or a log line of the function must not cost points
            with contextlib.redirect_stderr(sys.stdout):
                value = value(*arguments)
        except (Exception, SystemExit) as error:
            return wire.dumps({'raised': {'type': type(error).__name__, 'message': _text(error)}})
    return _reply(value)


def _has_endpoint(topic_name: str, end: str = '', type_name: str = '') -> bool:
    """Whether a node of this process publishes on a topic or subscribes to it.

    `end` is 'publishers', 'subscriptions', or '' for both; with `type_name`, only endpoints of
    that type count.
    """
    if 'rclpy' not in sys.modules:
        return False
    from my_robot_basics.session.neighbours import nodes_here

    return any(
        endpoint.topic_name == topic_name
        for node in nodes_here()
        if not node.get_name().startswith('_')
        for kind in ('publishers', 'subscriptions')
        for endpoint in getattr(node, kind)
        if end in ('', kind) and type_name in ('', values.type_name(endpoint.msg_type))
    )


def _last_raised(node_name: str) -> str:
    """Return the last exception in a callback of a node that `live` spins, or ''."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.last_raised(node_name) if troubles else ''


def _last_raised_ns(node_name: str) -> int:
    """Return when a callback of a node that `live` spins has raised last (monotonic); or 0."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.last_raised_ns(node_name) if troubles else 0


def _unpublished_field(node_name: str) -> tuple[str, str]:
    """Return the field that kept a node from publishing, and its type."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.unpublished_field(node_name) if troubles else ('', '')


def _how_answer_ended(_: str) -> tuple[str, str, str]:
    """Return the class of the answer if its node was ended, what took its place, and its name."""
    answer_end = sys.modules.get('my_robot_basics.live.nodes.answer_end')
    return answer_end.how_answer_ended() if answer_end else ('', '', '')


def _not_awaited(_: str) -> tuple[str, int, str]:
    """Return the coroutine that the answer has called without `await`, and the line of it."""
    unawaited = sys.modules.get('my_robot_basics.live.nodes.unawaited')
    return unawaited.first() if unawaited else ('', 0, '')


def _blocking_line(node_name: str) -> str:
    """Return the line at which a callback blocks a node that `live` spins, or ''."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.blocking_line(node_name) if troubles else ''


def _overwritten_attribute(node_name: str) -> str:
    """Return an attribute of rclpy's Node that a node of this process has overwritten, or ''."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.overwritten_attribute(node_name) if troubles else ''


def _logger_level(node_name: str) -> int:
    """Return the least severity that a node's logger logs; 0 if that is unknown."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.logger_level(node_name) if troubles else 0


def _sleeping_line(_: str) -> tuple[int, str]:
    """Return the line at which a callback sleeps most of the time; this takes half a second."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.sleeping_line() if troubles else (0, '')


def _sleeps_on(node_name: str, *args: float) -> tuple[int, str]:
    """Return the line at which a callback that blocks the node sleeps; it takes these seconds."""
    troubles = sys.modules.get('my_robot_basics.live.output.troubles')
    return troubles.sleeps_on(node_name, *args) if troubles else (0, '')


def _set_use_sim_time(node_name: str, value: bool) -> bool | None:
    """Set `use_sim_time` of a node of this process; return its former value.

    None if there is no such node or it refuses. This is for a node without parameter services,
    which only its own process can set.
    """
    if 'rclpy' not in sys.modules:
        return None
    from rclpy.parameter import Parameter

    from my_robot_basics.session.neighbours import nodes_here

    for node in nodes_here():
        if node.get_fully_qualified_name() == node_name:
            former = node.get_parameter('use_sim_time').value
            [result] = node.set_parameters([Parameter('use_sim_time', value=bool(value))])
            return former if result.successful else None
    return None


def _ask_package(package: str, verb: str, *args: Any) -> dict[str, Any] | None:
    """Ask `live` about a package that it has built, or to act on it; None without `live`."""
    packages = sys.modules.get('my_robot_basics.live.packages.packages')
    return packages.answer_check(package, verb, *args) if packages else None


def _settled_nodes(_: str, *args: float) -> list[str] | None:
    """Return the nodes of this process if nothing in it can create another endpoint, else None."""
    return settled.settled_nodes(*args)


_OTHERS: dict[str, Callable[..., object]] = {
    'endpoint': _has_endpoint,
    'settled': _settled_nodes,
    'trouble': _last_raised,
    'raised': _last_raised_ns,
    'field': _unpublished_field,
    'unfinished': _blocking_line,
    'not_awaited': _not_awaited,
    'sleeping': _sleeping_line,
    'sleeps_on': _sleeps_on,
    'overwritten': _overwritten_attribute,
    'level': _logger_level,
    'ended': _how_answer_ended,
    'clock': _set_use_sim_time,
    'package': _ask_package,
}


def _reply(value: object) -> str:
    try:
        text = wire.dumps({'ok': values.encode(value)})
    except values.UnsupportedValue as error:
        return wire.dumps({'unsupported': _text(error)})
    except Exception as error:
        # a list that changes while it is read, a dict subclass with its own methods, …
        return wire.dumps({'unsupported': f'{type(value).__name__} ({_text(error)})'})
    if len(text) > wire.MOST_BYTES:
        return wire.dumps({'failed': f'more than {wire.MOST_BYTES // 1024} kB of text'})
    return text


def _text(error: BaseException) -> str:
    try:
        return str(error)[:1000]
    except Exception:
        return 'an exception whose text raises an exception too'
