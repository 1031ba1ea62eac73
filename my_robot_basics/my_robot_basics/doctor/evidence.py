"""What the doctor has seen, and what a rule makes of it."""

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Literal

from rclpy.qos import QoSProfile, qos_profile_services_default

from my_robot_basics.doctor.callback import Callback

LARGEST_PAUSE_SEC = 0.005
"""Messages of one burst follow each other at least as fast as this …"""
PART_OF_PERIOD = 0.25
"""… and within this part of the mean time between two: a fast, steady flow is no burst."""

Kind = Literal['publisher', 'subscription', 'client', 'server']
VERBS: dict[Kind, str] = {
    'publisher': 'publishes',
    'subscription': 'subscribes',
    'client': 'asks',
    'server': 'serves',
}
"""What a node with such an endpoint does."""


@dataclass(frozen=True, kw_only=True)
class Endpoint:
    """One end of a topic or of a service, on one node."""

    kind: Kind
    node_name: str
    """Full name, such as `/kinematics_publisher`."""
    name: str
    """Of the topic or the service."""
    type_name: str
    """Such as `sensor_msgs/msg/JointState`."""
    qos_profile: QoSProfile = field(
        compare=False, default_factory=lambda: qos_profile_services_default
    )
    """As the graph tells it: without queue depth and history, which DDS does not transmit."""
    depth: int | None = None
    """Length of its queue, known for nodes of this process alone."""


@dataclass(frozen=True, kw_only=True)
class ReceivedMessage:
    """One message that the doctor has received."""

    message: Any
    sent_sec: float
    """On the wall clock, since the epoch: DDS's source timestamp."""


@dataclass(frozen=True, kw_only=True)
class NodeState:
    """What a node answers through its parameter services."""

    answers: bool | None
    """Whether it answered; None where it has no such services, and nothing is known."""
    use_sim_time: bool = False


@dataclass(frozen=True, kw_only=True)
class Remap:
    """A rule with which a process of this machine was started, to call one name by another."""

    command: str
    """What starts the process without the rule, for a shell."""
    name: str
    instead: str


@dataclass(frozen=True, kw_only=True)
class Seen:
    """The graph around one topic, or around one service."""

    name: str
    """The full name that was asked about."""
    endpoints: tuple[Endpoint, ...]
    """Of all topics (or all services) but ROS's own; those of hidden nodes are left out."""
    nodes: dict[str, NodeState]
    """Full names of all nodes that are not hidden."""
    remaps: tuple[Remap, ...] = ()
    domain_id: int = 0
    missing_participants: int = 0
    """Participants of this domain on this machine that are not on the graph."""
    elsewhere: dict[int, tuple[Endpoint, ...]] = field(default_factory=dict)
    """Endpoints of the name in other domains of this machine, where these were looked at."""
    callbacks: tuple[Callback, ...] = ()
    """Those of this process that went on all the time; none are known of other processes."""

    KINDS: ClassVar[tuple[Kind, Kind]]
    """Both ends, in the direction in which data (or a request) goes."""
    OF: ClassVar[str]
    """What links an end to a name: a publisher *on* a topic, a server *of* a service."""
    NEEDED: ClassVar[tuple[Kind, ...]]
    """The ends without which something is wrong."""

    def ends(self, kind: Kind) -> tuple[Endpoint, ...]:
        """The ends of that kind on the name that was asked about."""
        return tuple(end for end in self.endpoints if (end.kind, end.name) == (kind, self.name))

    def all_ends(self) -> tuple[Endpoint, ...]:
        """The ends of both kinds."""
        first, second = map(self.ends, self.KINDS)
        return first + second

    def busy(self, node_name: str) -> bool:
        """Whether a callback of this process keeps the node's other callbacks from running."""
        return any(node_name in each.holds for each in self.callbacks)

    def state(self, node_name: str) -> NodeState:
        """What a node answered."""
        return self.nodes.get(node_name, NodeState(answers=None))


@dataclass(frozen=True, kw_only=True)
class Evidence(Seen):
    """The graph around one topic, and what was received on it."""

    KINDS, OF = ('publisher', 'subscription'), 'on'
    NEEDED = KINDS

    has_clock: bool = False
    """Whether somebody publishes `/clock`."""
    received: tuple[ReceivedMessage, ...] = ()
    listened_sec: float = 0.0
    start_sec: float = 0.0
    """When the doctor began to listen, on the wall clock."""
    unknown_types: tuple[str, ...] = ()
    """Types of the topic's publishers that are not installed here: nobody could listen in."""

    @cached_property
    def publishers(self) -> tuple[Endpoint, ...]:
        """Those of the topic."""
        return self.ends('publisher')

    @cached_property
    def subscriptions(self) -> tuple[Endpoint, ...]:
        """Those of the topic."""
        return self.ends('subscription')

    @cached_property
    def fresh(self) -> tuple[ReceivedMessage, ...]:
        """The messages that were sent while the doctor looked: not those kept for late joiners."""
        return tuple(each for each in self.received if each.sent_sec >= self.start_sec)

    @property
    def rate_hz(self) -> float:
        """Messages per second by their source timestamps; 0 with fewer than two."""
        times = [each.sent_sec for each in self.fresh]
        return (len(times) - 1) / (times[-1] - times[0]) if len(set(times)) > 1 else 0.0

    @property
    def bursts(self) -> list[int]:
        """How many messages came in one go, each time; one message alone is a 1."""
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
    """One fault, in the words of a check: what was expected, what was seen, what to do."""

    title: str
    expected: str
    seen: str
    fix: str
    """A sentence that says what to do."""
    code: str = ''
    """The line that fixes it: Python in the node, or a command where it starts with `$ `."""
    broken: tuple[Endpoint, ...] = ()
    """Ends whose way to the topic, or from it, is broken."""
    missing: Kind | None = None
    """The end that nobody has."""


@dataclass(frozen=True)
class Diagnosis:
    """The evidence and what follows from it, the likeliest first; no finding: all is well."""

    evidence: Seen
    findings: tuple[Finding, ...]
