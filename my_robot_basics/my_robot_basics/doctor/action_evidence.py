"""The doctor's evidence on an action."""

from dataclasses import dataclass
from functools import cached_property

from my_robot_basics.doctor.evidence import Endpoint, GraphEvidence


@dataclass(frozen=True, kw_only=True)
class StandingGoal:
    """A goal that stayed in one state, without feedback, while it was observed."""

    state: str
    """'accepted', 'executing' or 'canceling'."""
    seconds: float
    """How long it was observed."""


@dataclass(frozen=True, kw_only=True)
class ActionEvidence(GraphEvidence):
    """The graph around one action, and what its server publishes about its goals."""

    KINDS, OF = ('client', 'server'), 'of'
    NEEDED = ('server',)

    goals: tuple[StandingGoal, ...] = ()
    unset: frozenset[str] = frozenset()
    """Nodes whose execute callback has recently returned without setting its goal's status."""
    raised: tuple[tuple[str, str], ...] = ()
    """A node, and the exception that its execute callback has recently raised."""
    proceeding: int = 0
    """How many unfinished goals make progress."""

    @cached_property
    def clients(self) -> tuple[Endpoint, ...]:
        """The clients of the action."""
        return self.ends('client')

    @cached_property
    def servers(self) -> tuple[Endpoint, ...]:
        """The servers of the action."""
        return self.ends('server')
