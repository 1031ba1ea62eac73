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


def _ask_live(
    module: str, function: str, otherwise: object, *, takes_name: bool = True
) -> Callable[..., object]:
    """Return what answers by a function of a module of `live`; `otherwise` if it is not imported.

    `takes_name`: the function takes the request's name.
    """

    def ask(name: str, *args: Any) -> object:
        imported = sys.modules.get(f'my_robot_basics.live.{module}')
        if imported is None:
            return otherwise
        return getattr(imported, function)(*([name] if takes_name else []), *args)

    return ask


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


def _settled_nodes(_: str, *args: float) -> list[str] | None:
    """Return the nodes of this process if nothing in it can create another endpoint, else None."""
    return settled.settled_nodes(*args)


_TROUBLES = 'output.troubles'
_OTHERS: dict[str, Callable[..., object]] = {
    'endpoint': _has_endpoint,
    'settled': _settled_nodes,
    'clock': _set_use_sim_time,
    'trouble': _ask_live(_TROUBLES, 'last_raised', ''),
    'raised': _ask_live(_TROUBLES, 'last_raised_ns', 0),
    'field': _ask_live(_TROUBLES, 'unpublished_field', ('', '')),
    'unfinished': _ask_live(_TROUBLES, 'blocking_line', ''),
    'sleeping': _ask_live(_TROUBLES, 'sleeping_line', (0, ''), takes_name=False),
    'sleeps_on': _ask_live(_TROUBLES, 'sleeps_on', (0, '')),
    'overwritten': _ask_live(_TROUBLES, 'overwritten_attribute', ''),
    'level': _ask_live(_TROUBLES, 'logger_level', 0),
    'not_awaited': _ask_live('nodes.unawaited', 'first', ('', 0, ''), takes_name=False),
    'ended': _ask_live('nodes.answer_end', 'how_answer_ended', ('', '', ''), takes_name=False),
    'package': _ask_live('packages.packages', 'answer_check', None),
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
