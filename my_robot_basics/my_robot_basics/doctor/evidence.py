"""The doctor's evidence, and the findings that rules derive from it."""

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Literal

from rclpy.qos import QoSProfile, qos_profile_services_default

from my_robot_basics.doctor.callback import Callback

LARGEST_PAUSE_SEC = 0.005
"""The largest pause between two messages of one burst."""
PART_OF_PERIOD = 0.25
"""The same as a part of the mean period: so a fast, steady stream does not count as a burst."""

Kind = Literal['publisher', 'subscription', 'client', 'server']
VERBS: dict[Kind, str] = {
    'publisher': 'publishes',
    'subscription': 'subscribes',
    'client': 'asks',
    'server': 'serves',
}
"""The verb for a node with such an endpoint."""


@dataclass(frozen=True, kw_only=True)
class Endpoint:
    """One end of a topic, a service or an action, on one node."""

    kind: Kind
    node_name: str
    """Full name, such as `/kinematics_publisher`."""
    name: str
    """Full name of the topic, the service or the action."""
    type_name: str
    """Full name of its type, such as `sensor_msgs/msg/JointState`."""
    qos_profile: QoSProfile = field(
        compare=False, default_factory=lambda: qos_profile_services_default
    )
    """As the graph has it: without queue depth and history, which DDS does not transmit."""
    depth: int | None = None
    """Depth of its queue; known only for nodes of this process."""


@dataclass(frozen=True, kw_only=True)
class ReceivedMessage:
    """One message that the doctor has received."""

    message: Any
    sent_sec: float
    """DDS's source timestamp, in seconds since the epoch on the wall clock."""


@dataclass(frozen=True, kw_only=True)
class NodeState:
    """What a node answers through its parameter services."""

    answers: bool | None
    """Whether it answered; None if unknown, because it has no such services or was not asked."""
    use_sim_time: bool = False


@dataclass(frozen=True, kw_only=True)
class Remap:
    """A remapping rule in the command line of a process on this machine."""

    command: str
    """The shell command that starts the process without the rule."""
    name: str
    instead: str


@dataclass(frozen=True, kw_only=True)
class GraphEvidence:
    """The graph around one topic, service or action."""

    name: str
    """The full name to diagnose."""
    endpoints: tuple[Endpoint, ...]
    """Those of all topics (or services, or actions) except ROS's own and hidden nodes'."""
    nodes: dict[str, NodeState]
    """Full names of all nodes that are not hidden."""
    remaps: tuple[Remap, ...] = ()
    domain_id: int = 0
    missing_participants: int = 0
    """How many participants of this domain on this machine are not on the graph."""
    elsewhere: dict[int, tuple[Endpoint, ...]] = field(default_factory=dict)
    """Endpoints with the name in other domains of this machine, if these were searched."""
    callbacks: tuple[Callback, ...] = ()
    """Callbacks of this process that have not returned; those of others are unknown."""

    KINDS: ClassVar[tuple[Kind, Kind]]
    """Both kinds of ends, in the direction in which messages (or requests) go."""
    OF: ClassVar[str]
    """The preposition before the name: a publisher *on* a topic, a server *of* a service."""
    NEEDED: ClassVar[tuple[Kind, ...]]
    """The kinds of ends that must exist, else there is a fault."""

    def ends(self, kind: Kind) -> tuple[Endpoint, ...]:
        """Return the ends of that kind with the diagnosed name."""
        return tuple(end for end in self.endpoints if (end.kind, end.name) == (kind, self.name))

    def all_ends(self) -> tuple[Endpoint, ...]:
        """Return the ends of both kinds with the diagnosed name."""
        first, second = map(self.ends, self.KINDS)
        return first + second

    def busy(self, node_name: str) -> bool:
        """Whether a callback of this process keeps the node's other callbacks from running."""
        return any(node_name in each.holds for each in self.callbacks)

    def state(self, node_name: str) -> NodeState:
        """Return what a node answered."""
        return self.nodes.get(node_name, NodeState(answers=None))


@dataclass(frozen=True, kw_only=True)
class Evidence(GraphEvidence):
    """The graph around one topic, and what was received on it."""

    KINDS, OF = ('publisher', 'subscription'), 'on'
    NEEDED = KINDS

    has_clock: bool = False
    """Whether a node publishes `/clock`."""
    received: tuple[ReceivedMessage, ...] = ()
    listened_sec: float = 0.0
    start_sec: float = 0.0
    """When the doctor subscribed, on the wall clock."""
    unknown_types: tuple[str, ...] = ()
    """Types of the topic's publishers that are not installed here: the doctor can't subscribe."""

    @cached_property
    def publishers(self) -> tuple[Endpoint, ...]:
        """The publishers on the topic."""
        return self.ends('publisher')

    @cached_property
    def subscriptions(self) -> tuple[Endpoint, ...]:
        """The subscriptions on the topic."""
        return self.ends('subscription')

    @cached_property
    def fresh(self) -> tuple[ReceivedMessage, ...]:
        """The messages that were sent during the look, not those kept for late subscribers."""
        return tuple(each for each in self.received if each.sent_sec >= self.start_sec)

    @property
    def rate_hz(self) -> float:
        """Messages per second by their source timestamps; 0 with fewer than two."""
        times = [each.sent_sec for each in self.fresh]
        return (len(times) - 1) / (times[-1] - times[0]) if len(set(times)) > 1 else 0.0

    @property
    def bursts(self) -> list[int]:
        """The number of messages in each burst; a single message is a 1."""
        times = [each.sent_sec for each in self.fresh]
        period_sec = self.listened_sec / max(1, len(times))
        most_sec = min(LARGEST_PAUSE_SEC, PART_OF_PERIOD * period_sec)
        lengths = [1] * bool(times)
        for earlier, later in itertools.pairwise(times):
            if later - earlier <= most_sec:
                lengths[-1] += 1
            else:
                lengths.append(1)
        return lengths


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One fault, described as in a check: what was expected, what was seen, what to do."""

    title: str
    expected: str
    seen: str
    fix: str
    """A sentence that says what to do."""
    code: str = ''
    """The line that fixes it: Python in the node, or a shell command if it starts with `$ `."""
    broken: tuple[Endpoint, ...] = ()
    """Ends whose connection to the topic, service or action is broken."""
    missing: Kind | None = None
    """The kind of end that no node has."""


@dataclass(frozen=True)
class Diagnosis:
    """The evidence and its findings, the likeliest first; without findings, all is well."""

    evidence: GraphEvidence
    findings: tuple[Finding, ...]
