"""Ask the notebook under test for plain values, by name; the check judges them on its own side.

From the test kernel, a request goes to the grader, which passes it to the student's kernel. In
the student's own kernel, the same request is answered in the same process.
"""

import builtins
from typing import Any

from my_robot_basics.exchange import values, wire
from my_robot_basics.exchange.asking import reply_value, send
from my_robot_basics.exchange.expected_types import (
    brief,
    cause_of_wrong_type,
    check_type,
    kind_of,
    wanted_type,
    what_is_unsupported,
)
from my_robot_basics.feedback import hidden
from my_robot_basics.feedback.errors import fail, shorten
from my_robot_basics.feedback.python_errors import hint_for_exception
from my_robot_basics.session import interactions

__all__ = ['call', 'value']

_ANSWER_CELL = 'in the answer cell, and run the cell'


def call(name: str, *args: object, returns: type | tuple[type, ...] | None = None) -> Any:
    """Call the student's function and return what it returned: `call('reach', 1.0, 0.5)`.

    Arguments and result are plain values or ROS messages (see values.py). With `returns`, any
    other type fails the check; a bool is not an int, an int is accepted as a float. Raises
    CheckFailed if there is no such function, or it raises, returns None, or takes over 10 s.
    """
    shown = hidden.student_text(
        shorten(f'{name}({", ".join(brief(argument) for argument in args)})')
    )
    interactions.note()
    kind, body = _ask(wire.request(op='call', name=name, args=args), shown)
    if kind == 'missing':
        _fail_missing(name, what='function')
    if kind == 'raised':
        raised = shorten(': '.join(filter(None, (body['type'], body['message']))))
        hint, why = f'call {shown} in a cell of your own to see where', hint_for_exception(raised)
        said = hidden.student_exception(raised)
        cause, seen = f'`{name}` raises {said}', raised
        if why:
            cause, seen = f'`{name}` raises `{said}`{why}', f'it raised `{raised}`{why}'
        fail(expected=f'`{shown}` to return', seen=seen, hint=hint, cause=cause)
    if kind == 'unsupported':
        seen, hint = what_is_unsupported(body, returns)
        wanted = f'`{shown}` to return {wanted_type(returns)}'
        fail(expected=wanted, seen=seen, hint=hint, cause=cause_of_wrong_type(name, returns))
    if body is None:
        hint = (
            f'end each branch of `{name}` with `return …` (printing a result does not return it)'
        )
        fail(
            expected=f'`{shown}` to return a value',
            seen='None',
            hint=hint,
            cause=f'`{name}` returns None',
        )
    check_type(
        body, returns, what=f'`{shown}` to return', cause=cause_of_wrong_type(name, returns)
    )
    return body


def value(name: str, *, type: builtins.type | tuple[builtins.type, ...] | None = None) -> Any:
    """Return the value of a name of the notebook; with `type`, any other type fails the check.

    It is a plain value (number, text, list, tuple, set, dict) or a ROS message. Raises
    CheckFailed if the notebook has no such name, or a value that cannot be transmitted.
    """
    kind, body = _ask(wire.request(op='value', name=name), name)
    if kind == 'missing':
        _fail_missing(name, what='value')
    if kind == 'unsupported':
        hint = 'use plain values (numbers, text, lists, tuples, sets, dicts)'
        seen = kind_of(body)
        fail(expected=f'`{name}` to be {wanted_type(type)}', seen=seen, hint=hint)
    if body is None and type is not None:
        hint = f'give `{name}` its value {_ANSWER_CELL}'
        fail(expected=f'`{name}` to be {wanted_type(type)}', seen='None', hint=hint)
    check_type(body, type, what=f'`{name}` to be', cause=f'`{name}` is not {wanted_type(type)}')
    return body


def has_endpoint(topic_name: str, end: str = '', type_name: str = '') -> bool:
    """Whether the notebook's process has an endpoint on a topic; True if it does not answer.

    `end` is 'publishers', 'subscriptions', or '' for both; with `type_name`, only endpoints of
    that type count. It saves waiting for what can't come; the verdict depends on the graph.
    """
    question = wire.request(op='endpoint', name=topic_name, args=(end, type_name))
    try:
        kind, body = wire.parse_reply(send(question))
    except values.WireError:
        return True
    return kind != 'ok' or body is not False


def publishes(topic_name: str) -> bool:
    """Whether the notebook's process reports a publisher, possibly before the graph shows it."""
    request = wire.request(op='endpoint', name=topic_name, args=('publishers', ''))
    return reply_value(request) is True


def settled_nodes() -> list[str] | None:
    """Return the full names of the notebook's nodes; None if more may come, or without answer.

    It saves waiting for what can't come; the verdict depends on the graph.
    """
    question = wire.request(op='settled', name='', args=(hidden.checked_for_sec(),))
    body = reply_value(question)
    is_told = isinstance(body, list) and all(isinstance(name, str) for name in body)
    return body if is_told else None


def set_use_sim_time(node_name: str, value: bool) -> bool | None:
    """Set `use_sim_time` of a node of the notebook's process; return its former value.

    None if that process has no such node, or does not answer, or the node refuses. It serves
    nodes without parameter services; the verdict depends on what the node publishes.
    """
    body = reply_value(wire.request(op='clock', name=node_name, args=(value,)))
    return body if isinstance(body, bool) else None


def ask_package(package: str, verb: str, *args: object) -> dict[str, Any]:
    """Return what the notebook reports of a package that it has built; {} without an answer.

    The student's room claims what it has started and with which exit code that ended; this is no
    evidence. The check observes over DDS what a package does.
    """
    interactions.note()
    body = reply_value(wire.request(op='package', name=package, args=(verb, *args)))
    is_told = isinstance(body, dict) and all(isinstance(key, str) for key in body)
    return body if is_told else {}


def _ask(question: str, shown: str) -> tuple[str, Any]:
    try:
        kind, body = wire.parse_reply(send(question))
    except values.WireError as error:
        hint = 'return plain values (numbers, text, lists, dicts) or a ROS message'
        fail(expected=f'an answer from `{shown}`', seen=error, hint=hint)
    if kind == 'failed':
        hint = 'look for a loop or a print without end, a large result, or a kernel that died'
        cause = 'your code does not answer'
        fail(expected=f'an answer from `{shown}`', seen=shorten(body), hint=hint, cause=cause)
    return kind, body


def _fail_missing(name: str, *, what: str) -> None:
    wanted, hint = f'a value for `{name}`', f'assign a value to `{name}` {_ANSWER_CELL}'
    if what == 'function':
        wanted, hint = (
            f'a function named `{name}`',
            f'define it as `def {name}(…):` {_ANSWER_CELL}',
        )
    fail(expected=wanted, seen='no such name', hint=hint)
