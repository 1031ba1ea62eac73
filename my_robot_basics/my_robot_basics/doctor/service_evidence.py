"""What the doctor has seen of a service."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from my_robot_basics.doctor.evidence import Endpoint, Seen


@dataclass(frozen=True, kw_only=True)
class Unanswered:
    """The last request of a client of this process, which had no answer all the time."""

    node_name: str
    seconds: float
    """How long it was looked at."""


@dataclass(frozen=True, kw_only=True)
class ServiceEvidence(Seen):
    """The graph around one service, and what its nodes do, as far as this process can know."""

    KINDS, OF = ('client', 'server'), 'of'
    NEEDED = ('server',)

    looked_sec: float = 0.0
    """How long its nodes were given to answer a question."""
    raised: Mapping[str, str] = field(default_factory=dict)
    """What a node's callback of this service raised last, and where; of nodes that `live` runs."""
    visible: frozenset[str] = frozenset()
    """Nodes of this process, into whose callbacks the doctor could look."""
    unspun: frozenset[str] = frozenset()
    """Those of them that no thread has spun."""
    taken: frozenset[str] = frozenset()
    """Those of them that were taken from the executor that spun them."""
    unanswered: tuple[Unanswered, ...] = ()

    @cached_property
    def clients(self) -> tuple[Endpoint, ...]:
        """Those of the service."""
        return self.ends('client')

    @cached_property
    def servers(self) -> tuple[Endpoint, ...]:
        """Those of the service."""
        return self.ends('server')
