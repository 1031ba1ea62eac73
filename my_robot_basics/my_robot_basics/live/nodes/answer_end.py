"""Whether a cell has ended the node of the answer, and how: then a check sees no node at all."""

from collections.abc import Iterable
from dataclasses import dataclass

_STOPPED = '', ''


@dataclass
class Answer:
    """The node that `run_answer` has started last."""

    key: str = ''
    """Under which `live` runs it: the name of its class."""
    ended: tuple[str, str] | None = None
    """The key of the node that has taken its place, and the name of both; two empty texts if it
    was stopped; None while it runs."""


_answer = Answer()


def watch_answer(key: str) -> None:
    """Look from now on at the node of this key; at none if it is ''."""
    _answer.key, _answer.ended = key, None


def note_restart(key: str) -> None:
    """Drop what was noted about this node, because it is starting again."""
    if key == _answer.key:
        _answer.ended = None


def note_end(keys: Iterable[str], how: tuple[str, str] = _STOPPED) -> list[str]:
    """Note that `live` ends these nodes; return them. `how` is as in `Answer.ended`."""
    ending = list(keys)
    if _answer.key and _answer.key in ending:
        _answer.ended = how
    return ending


def running_answer() -> str:
    """Return the key of the answer's node while it runs, else ''."""
    return '' if _answer.ended is not None else _answer.key


def how_answer_ended() -> tuple[str, str, str]:
    """Return the key of the answer's node if it was ended, else '', and how it was ended."""
    return ('', *_STOPPED) if _answer.ended is None else (_answer.key, *_answer.ended)
