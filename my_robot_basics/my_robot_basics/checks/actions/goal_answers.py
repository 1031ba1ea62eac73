"""How an action server answered the goals of checks, in this grade cell and earlier ones."""

from dataclasses import dataclass, replace

Identity = tuple[tuple[int, ...], ...]
"""Identifies a server, even among servers of the same name: see `OpenAction.identity`."""
_answers: dict[Identity, 'GoalAnswers'] = {}


@dataclass(frozen=True)
class GoalAnswers:
    """What is known of the answers of one server."""

    accepted_ns: int = 0
    """When the last goal that it accepted was sent: wall time in ns; 0 if it accepted none."""
    has_rejected_last: bool = False
    """Whether it rejected the last goal."""
    why_rejected: str = ''
    """The advice of a check when a valid goal was rejected; '' if one was accepted since.

    A server that never becomes ready again rejects all later goals: the first rejection shows why.
    """


def answers_of(server: Identity) -> GoalAnswers:
    """The answers of a server so far."""
    return _answers.get(server, GoalAnswers())


def note_answer(server: Identity, *, sent_ns: int, is_accepted: bool) -> None:
    """Note the answer to a goal that was sent at `sent_ns` (wall time)."""
    if is_accepted:
        _answers[server] = GoalAnswers(sent_ns)
    else:
        _answers[server] = replace(answers_of(server), has_rejected_last=True)


def note_why_rejected(server: Identity, why: str) -> None:
    """Note a check's advice about a goal that was rejected but had to be accepted."""
    _answers[server] = replace(answers_of(server), why_rejected=why)
