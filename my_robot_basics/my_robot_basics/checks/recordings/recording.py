"""A recording of a topic: the assertions of a check about its messages."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from my_robot_basics.checks.recordings import (
    callbacks,
    periods,
    pictures,
    positions,
    rate_failure,
    rates,
    stamps,
)
from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages
from my_robot_basics.checks.values import joints
from my_robot_basics.feedback.errors import CheckFailed, Starved, expect, shorten, show

SECOND_LOOK_SEC = 4.0
LONGER_LOOK_SEC = 8.0
"""How long to record again on the wall clock if the first recording leaves the period in doubt."""
LONGEST_LOOK_SEC = 12.0
MISDATED_SEC = 0.1
"""A message that arrives so long after, or before, the time at which it says it was sent is
misdated: DDS takes a millisecond, and the sender writes that time."""


@dataclass(frozen=True, kw_only=True)
class Recording(RecordedMessages):
    """The messages of a topic over `seconds`, and what a check may assert about them."""

    look_again: Callable[[float], 'Recording'] | None = field(default=None, repr=False)
    """Makes another recording of that many seconds on the wall clock."""

    def assert_rate(self, hz: float) -> None:
        """There is one publisher, and it sends `hz` messages per second, evenly, within ±2 %.

        Otherwise raises CheckFailed. Before that it records again on the wall clock, for longer if
        the rate is in doubt, and repeatedly if the machine is too busy for a node to keep its
        rate. It does not if the robot's clock has shown another period for certain, or the wall
        clock far too many messages. A callback that raised fails: `rclpy.spin` would have ended.
        """
        self._expect_one_publisher()
        self._expect_true_times()
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
        messages, may_look_again = self._messages_with('header'), self.look_again is not None
        stamps.check_stamps(self, messages, may_look_again=may_look_again)

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
        publishers = *self.publishers, *self.hidden_publishers
        names = set(publishers)
        expect(
            len(publishers) == 1,
            expected=f'one publisher on {self.topic_name}',
            seen=f'{len(publishers)} ({shorten(", ".join(sorted(names)))})',
            hint='stop the other node: two publishers on a topic add up'
            if len(names) > 1
            else 'call create_publisher for this topic once, and start the node once',
        )

    def _expect_true_times(self) -> None:
        """Most messages arrive when they say they were sent. Raises CheckFailed."""
        offsets = [each.offset_sec for each in self.messages]
        # of two that are sent at once, one may say an earlier time and the other a later one
        apart = [later - earlier for earlier, later in itertools.pairwise(offsets)]
        misdated = max(
            sum(abs(each) > MISDATED_SEC for each in group) for group in (offsets, apart)
        )
        expect(
            misdated <= len(self.messages) / 2,
            expected=f'messages on {self.topic_name} that arrive when they are sent',
            seen=f'{misdated} that arrive 0.1 s before or after the time that they say',
            hint='call publish(…) of a publisher of rclpy, which writes that time itself',
            cause='messages arrive at other times than they say',
            doubt=Starved if self.late_sec > MISDATED_SEC else CheckFailed,
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
