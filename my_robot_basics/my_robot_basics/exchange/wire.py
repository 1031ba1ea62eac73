"""The texts that are sent between the test kernel and the student's kernel: bounded JSON."""

import json
import math
from typing import Any

from my_robot_basics.exchange.values import WireError, decode, encode

PROTOCOL = 'my_robot_basics.student/1'
MOST_BYTES = 64 * 1024
THREADS = ''
"""In the place of a node's name: the threads that the notebook has started itself."""
_REPLIES = {'ok': object, 'raised': dict, 'missing': str, 'unsupported': str, 'failed': str}


def dumps(message: object) -> str:
    """Return the JSON text of a request or reply."""
    return json.dumps(message, allow_nan=False, separators=(',', ':'))


def loads(text: object) -> dict:
    """Return the JSON object in a text of at most MOST_BYTES. Raises only WireError."""
    if not isinstance(text, str):
        raise WireError('not a text')
    if len(text) > MOST_BYTES:
        raise WireError(f'more than {MOST_BYTES // 1024} kB of text')
    try:
        loaded = json.loads(text, parse_constant=_refuse, parse_float=_finite)
    except (ValueError, RecursionError) as error:
        raise WireError('not the JSON of a reply') from error
    if not isinstance(loaded, dict):
        raise WireError('not a JSON object')
    return loaded


def request(*, op: str, name: str, args: tuple = ()) -> str:
    """Return a request's text: `op` is one that responder.py knows, `name` is its subject."""
    body = {'protocol': PROTOCOL, 'op': op, 'name': name, 'args': [encode(a) for a in args]}
    return dumps(body)


def parse_reply(text: object) -> tuple[str, Any]:
    """Return a reply's kind ('ok', 'raised', 'missing', 'unsupported', 'failed') and its body.

    The body of 'ok' is the decoded value, of 'raised' {'type': str, 'message': str}, of the
    others a str. Raises only WireError.
    """
    reply = loads(text)
    if len(reply) != 1:
        raise WireError('a reply that is not exactly one answer')
    ((kind, body),) = reply.items()
    if kind not in _REPLIES or not isinstance(body, _REPLIES[kind]):
        raise WireError('a reply of an unknown kind')
    if kind == 'ok':
        return kind, decode(body)
    if kind == 'raised' and not _is_exception(body):
        raise WireError('an exception without type and message')
    return kind, body


def _is_exception(body: object) -> bool:
    if not isinstance(body, dict):
        return False
    return set(body) == {'type', 'message'} and all(isinstance(v, str) for v in body.values())


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError('a number out of range')
    return number


def _refuse(text: str) -> float:
    raise ValueError(f'{text} is not JSON')
