"""The doctor's evidence on a service or an action, which have clients and servers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from my_robot_basics.doctor.evidence import Endpoint, GraphEvidence


@dataclass(frozen=True, kw_only=True)
class ServedEvidence(GraphEvidence):
    """The graph around one service or action."""

    KINDS, OF = ('client', 'server'), 'of'
    NEEDED = ('server',)

    @cached_property
    def clients(self) -> tuple[Endpoint, ...]:
        """The clients of the service or action."""
        return self.ends('client')

    @cached_property
    def servers(self) -> tuple[Endpoint, ...]:
        """The servers of the service or action."""
        return self.ends('server')


@dataclass(frozen=True, kw_only=True)
class Unanswered:
    """The last request of a client of this process, if it had no answer during the whole look."""

    node_name: str
    seconds: float
    """How long it was observed."""


@dataclass(frozen=True, kw_only=True)
class ServiceEvidence(ServedEvidence):
    """The graph around one service, and what its nodes do, as far as this process can observe."""

    looked_sec: float = 0.0
    """How long its nodes had to answer a parameter request."""
    raised: Mapping[str, str] = field(default_factory=dict)
    """By node, the last exception of its callback of this service; only nodes that `live` runs."""
    visible: frozenset[str] = frozenset()
    """Nodes of this process whose callbacks the doctor could observe."""
    unspun: frozenset[str] = frozenset()
    """Nodes of this process that no thread has spun."""
    taken: frozenset[str] = frozenset()
    """Nodes of this process that were removed from the executor that spun them."""
    unanswered: tuple[Unanswered, ...] = ()


@dataclass(frozen=True, kw_only=True)
class StandingGoal:
    """A goal that stayed in one state, without feedback, while it was observed."""

    state: str
    """'accepted', 'executing' or 'canceling'."""
    seconds: float
    """How long it was observed."""


@dataclass(frozen=True, kw_only=True)
class ActionEvidence(ServedEvidence):
    """The graph around one action, and what its server publishes about its goals."""

    goals: tuple[StandingGoal, ...] = ()
    unset: frozenset[str] = frozenset()
    """Nodes whose execute callback has recently returned without setting its goal's status."""
    raised: tuple[tuple[str, str], ...] = ()
    """A node, and the exception that its execute callback has recently raised."""
    proceeding: int = 0
    """How many unfinished goals make progress."""
