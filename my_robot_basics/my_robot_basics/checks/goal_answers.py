"""How an action server has answered the goals of checks, in this grade cell or an earlier one."""

from dataclasses import dataclass

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


def answers_of(server: Identity) -> GoalAnswers:
    """What is known of a server."""
    return _answers.get(server, GoalAnswers())


def note_answer(server: Identity, *, sent_ns: int, is_accepted: bool) -> None:
    """Note its answer to a goal that was sent at that wall time."""
    accepted_ns = sent_ns if is_accepted else answers_of(server).accepted_ns
    _answers[server] = GoalAnswers(accepted_ns, has_rejected_last=not is_accepted)
