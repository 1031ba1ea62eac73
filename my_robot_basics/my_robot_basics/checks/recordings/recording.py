"""The messages recorded on a topic, and the assertions of a check about them."""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from my_robot_basics.checks.recordings import (
    callbacks,
    periods,
    pictures,
    positions,
    rate_failure,
    rates,
    stamps,
)
from my_robot_basics.checks.values import joints
from my_robot_basics.feedback.errors import CheckFailed, expect, shorten, show

SECOND_LOOK_SEC = 4.0
LONGER_LOOK_SEC = 8.0
"""How long to record again on the wall clock if the first recording leaves the period in doubt."""
LONGEST_LOOK_SEC = 12.0


@dataclass(frozen=True)
class Sample:
    """One message and when it was sent."""

    message: Any
    """The message as it arrived."""
    time_sec: float
    """When it was sent, on the recording's clock, since the recording began."""
    source_time_sec: float
    """When it was sent, on the wall clock, since the epoch: DDS's source timestamp."""


@dataclass(frozen=True, kw_only=True)
class Recording:
    """The messages of a topic over `seconds`, which begin at a message that does not count."""

    topic_name: str
    messages: tuple[Sample, ...]
    """Oldest first; the one at which the recording began is not among them."""
    clock: Literal['simulated', 'wall']
    """The clock of `seconds` and of the samples' `time_sec`."""
    publishers: tuple[str, ...]
    """Full names of the nodes that publish on the topic, one for each publisher."""
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
    proof: 'Recording | None' = field(default=None, repr=False)
    """A second recording on the simulated clock, with steps of another size."""
    look_again: Callable[[float], 'Recording'] | None = field(default=None, repr=False)
    """Makes another recording of that many seconds on the wall clock."""

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
        return not self.messages or self.silent_sec * self.rate_hz > rates.SILENT_PERIODS

    @property
    def is_over(self) -> bool:
        """Whether the messages have ended, and the silence is longer than any earlier pause."""
        is_longest = self.silent_sec > rates.LONGER_PAUSE * self.largest_gap_sec
        return not self.messages or (self.has_ended and is_longest)

    def assert_rate(self, hz: float) -> None:
        """There is one publisher, and it sends `hz` messages per second, evenly, within ±2 %.

        Otherwise raises CheckFailed. Before that it records again on the wall clock, for longer if
        the rate is in doubt, and repeatedly if the machine is too busy for a node to keep its
        rate. It does not if the robot's clock has shown another period for certain, or the wall
        clock far too many messages. A callback that raised fails: `rclpy.spin` would have ended.
        """
        self._expect_one_publisher()
        callbacks.expect_none_so_far(self.publishers)
        is_right, is_doubtful = rates.has_rate(self, hz), rates.is_doubtful(self, hz)
        seconds, second = LONGER_LOOK_SEC if is_doubtful else SECOND_LOOK_SEC, None
        if not is_right or is_doubtful:
            second = self._look_again(hz, seconds=seconds)
        if is_right and (second is None or not rates.is_steady(second, hz)):
            if self.note:
                print(self.note)
        elif second is None:
            rate_failure.fail_rate(self, hz)
        else:
            second.assert_rate(hz)

    def assert_joint_names(self, names: Sequence[str]) -> None:
        """Every message names exactly these joints, in any order. Raises CheckFailed."""
        for message in self._messages_with('name'):
            expect(
                sorted(message.name) == sorted(names),
                expected=f'the joint names {", ".join(map(repr, names))}',
                seen=shorten(', '.join(map(repr, message.name))) or 'none',
                hint=joints.why_names(message.name, names),
            )

    def assert_positions_rad(
        self, *, low: Sequence[float], high: Sequence[float], names: Sequence[str] = ()
    ) -> None:
        """Every message has one position for each joint, in radians between low and high.

        `names` are the joints of `low` and `high`; a message may have them in any order.
        """
        messages = self._messages_with('position')
        positions.check_positions(messages, low, high, names)

    def assert_frame_id(self, frame_id: str) -> None:
        """Every message's header has that frame_id. Raises CheckFailed."""
        for message in self._messages_with('header'):
            expect(
                message.header.frame_id == frame_id,
                expected=f"frame_id '{frame_id}'",
                seen=shorten(repr(message.header.frame_id)),
                hint=f"set message.header.frame_id = '{frame_id}' before publishing",
            )

    def assert_stamps(self) -> None:
        """Every stamp is the time of the node's clock at publication. Raises CheckFailed."""
        stamps.check_stamps(self, self._messages_with('header'))

    def plot(self, hz: float | None = None) -> None:
        """Plot when the messages arrived and, with `hz`, when they should have arrived."""
        alt = f'Arrivals of {len(self.messages)} messages on {self.topic_name}'
        show(pictures.plot_arrivals(self, hz=hz), alt=alt)

    def _look_again(self, hz: float, *, seconds: float) -> 'Recording | None':
        """Another recording on the wall clock, or None if that is impossible or cannot help."""
        if self.look_again is None or rates.is_certain(self, hz) or self._is_too_fast(hz):
            return None
        try:
            return self.look_again(min(max(seconds, 3.0 / hz), LONGEST_LOOK_SEC))
        except CheckFailed:  # the node has gone, or no time is left: judge the first recording
            return None

    def _is_too_fast(self, hz: float) -> bool:
        """Whether the wall clock shows a faster rate for certain: a busy machine only delays."""
        if self.clock != 'wall' or self.was_busy:
            return False
        return periods.come_too_often(rates.times_of(self), hz, seconds=self.seconds)

    def _expect_one_publisher(self) -> None:
        names = set(self.publishers)
        expect(
            len(self.publishers) == 1,
            expected=f'one publisher on {self.topic_name}',
            seen=f'{len(self.publishers)} ({shorten(", ".join(sorted(names)))})',
            hint='stop the other node: two publishers on a topic add up'
            if len(names) > 1
            else 'call create_publisher for this topic once, and start the node once',
        )

    def _messages_with(self, field_name: str) -> list:
        messages = [sample.message for sample in self.messages]
        expect(
            bool(messages),
            expected=f'messages on {self.topic_name}',
            seen='none',
            hint='record for longer than the period of the publisher',
        )
        for message in messages[:1]:
            expect(
                hasattr(message, field_name),
                expected=f'messages with a {field_name} on {self.topic_name}',
                seen=type(message).__name__,
                hint='compare the message type in create_publisher(…)',
            )
        return messages
