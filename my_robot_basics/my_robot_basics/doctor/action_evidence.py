"""What the doctor has seen of an action."""

from dataclasses import dataclass
from functools import cached_property

from my_robot_basics.doctor.evidence import Endpoint, Seen


@dataclass(frozen=True, kw_only=True)
class StandingGoal:
    """A goal that was in one state all the time, without feedback on it."""

    state: str
    """'accepted', 'executing' or 'canceling'."""
    seconds: float
    """How long it was looked at."""


@dataclass(frozen=True, kw_only=True)
class ActionEvidence(Seen):
    """The graph around one action, and what its server tells everybody of its goals."""

    KINDS, OF = ('client', 'server'), 'of'
    NEEDED = ('server',)

    goals: tuple[StandingGoal, ...] = ()
    unset: frozenset[str] = frozenset()
    """Nodes whose execute callback returned lately, and had set no status of its goal."""
    raised: tuple[tuple[str, str], ...] = ()
    """A node, and what its execute callback has raised lately."""
    proceeding: int = 0
    """Goals that are not over, and go on."""

    @cached_property
    def clients(self) -> tuple[Endpoint, ...]:
        """Those of the action."""
        return self.ends('client')

    @cached_property
    def servers(self) -> tuple[Endpoint, ...]:
        """Those of the action."""
        return self.ends('server')
