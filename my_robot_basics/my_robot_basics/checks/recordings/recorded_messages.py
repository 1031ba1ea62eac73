"""The messages that were recorded on a topic: what all judgements of a recording are about."""

import itertools
import math
from dataclasses import dataclass, field
from typing import Any, Literal

SILENT_PERIODS = 2.75
"""A longer silence at the end, in periods, means that the messages have ended. It is more than one
period because the last message may still be on its way."""
LONGER_PAUSE = 1.5
"""The silence at the end must also be this many times as long as the longest gap before it."""


@dataclass(frozen=True)
class Sample:
    """One message and when it was sent."""

    message: Any
    """The message as it arrived."""
    time_sec: float
    """When it was sent, on the recording's clock, since the recording began."""
    source_time_sec: float
    """When it was sent, on the wall clock, since the epoch: DDS's source timestamp."""
    offset_sec: float = 0.0
    """How long after that it arrived; on the wall clock."""


@dataclass(frozen=True, kw_only=True)
class RecordedMessages:
    """The messages of a topic over `seconds`, which begin at a message that does not count."""

    topic_name: str
    messages: tuple[Sample, ...]
    """Oldest first; the one at which the recording began is not among them."""
    clock: Literal['simulated', 'wall']
    """The clock of `seconds` and of the samples' `time_sec`."""
    publishers: tuple[str, ...]
    """Full names of the nodes that publish on the topic, one for each publisher."""
    hidden_publishers: tuple[str, ...] = ()
    """The same for nodes whose names start with `_`."""
    seconds: float
    start_sec: float
    """When the recording began, on its clock, since the epoch."""
    step_sec: float = 0.0
    """How far each tick moved the simulated clock; 0 on the wall clock."""
    note: str = ''
    """A remark for the feedback that costs no points."""
    late_sec: float = 0.0
    """The longest delay of the recording itself by a busy machine: a node may be as late."""
    was_busy: bool = False
    """Whether processes waited for a processor for most of the recording."""
    is_makeshift: bool = False
    """Whether it is on the wall clock only because a busy machine was too slow for the robot's."""
    proof: 'RecordedMessages | None' = field(default=None, repr=False)
    """A second recording on the simulated clock, with steps of another size."""

    @property
    def rate_hz(self) -> float:
        """Messages per second, from the beginning to the last message; 0 without a message."""
        return len(self.messages) / self.messages[-1].time_sec if self.messages else 0.0

    @property
    def largest_gap_sec(self) -> float:
        """The longest gap between two messages, in s; infinite without a message."""
        times = [0.0, *(sample.time_sec for sample in self.messages)]
        return max((b - a for a, b in itertools.pairwise(times)), default=math.inf)

    @property
    def silent_sec(self) -> float:
        """The time between the last message and the end of the recording."""
        return self.seconds - self.messages[-1].time_sec if self.messages else self.seconds

    @property
    def has_ended(self) -> bool:
        """Whether the silence at the end is so long that the messages seem to have ended."""
        return not self.messages or self.silent_sec * self.rate_hz > SILENT_PERIODS

    @property
    def is_over(self) -> bool:
        """Whether the messages have ended, and the silence is longer than any earlier pause."""
        is_longest = self.silent_sec > LONGER_PAUSE * self.largest_gap_sec
        return not self.messages or (self.has_ended and is_longest)
