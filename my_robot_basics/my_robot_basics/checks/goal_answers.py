"""How an action server has answered the goals of checks, in this grade cell or an earlier one."""

from dataclasses import dataclass, replace

Identity = tuple[tuple[int, ...], ...]
"""What no other server has, whatever its name: `OpenAction.identity`."""
_answers: dict[Identity, 'GoalAnswers'] = {}


@dataclass(frozen=True)
class GoalAnswers:
    """The answers of one server so far."""

    accepted_ns: int = 0
    """When the last goal was sent that it has accepted: wall time in ns; 0: none."""
    has_rejected_last: bool = False
    """Whether it has rejected the last goal of all."""
    why_rejected: str = ''
    """What a check said when it rejected a goal that was right; '' if it accepted one since.

    A server that locks itself rejects all that come: the first time tells why.
    """


def answers_of(server: Identity) -> GoalAnswers:
    """What is known of a server."""
    return _answers.get(server, GoalAnswers())


def note_answer(server: Identity, *, sent_ns: int, is_accepted: bool) -> None:
    """Note its answer to a goal that was sent at that wall time."""
    if is_accepted:
        _answers[server] = GoalAnswers(sent_ns)
    else:
        _answers[server] = replace(answers_of(server), has_rejected_last=True)


def note_why_rejected(server: Identity, why: str) -> None:
    """Note what was said of a goal that it has rejected, and had to accept."""
    _answers[server] = replace(answers_of(server), why_rejected=why)
