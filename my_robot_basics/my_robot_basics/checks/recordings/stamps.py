"""Whether stamps are the time of the node's clock at publication, and the message if not.

On the wall clock, the node's clock and the computer's show the same time, so a recording proves
nothing: then `own_clock` moves the node's clock ahead, and its stamps must follow.
"""

import itertools
import statistics
from collections.abc import Sequence
from typing import Any, NoReturn

from my_robot_basics.checks.clock.own_clock import (
    EXPECTED,
    HOW,
    expect_to_follow,
    fail_computer,
    nanoseconds,
)
from my_robot_basics.checks.recordings.rates import AT_ONCE_SEC, ONCE
from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages
from my_robot_basics.checks.values.content import content
from my_robot_basics.feedback.errors import CheckFailed, Starved, fail

MOST_OFF_SEC = {'simulated': 0.5, 'wall': 1.0}
"""How far each stamp may be from the time of publication, by clock."""
USUAL_OFF_SEC = 0.15
"""How far the median stamp may be: less than a period at 5 Hz, to detect the preceding stamp."""


def check_stamps(recording: RecordedMessages, messages: Sequence, *, may_look_again: bool) -> None:
    """Each stamp is set, advances, and is near the time of publication. Raises CheckFailed.

    With `may_look_again`, the node still runs: its stamps must also be of the node's clock.
    """
    stamps_ns = [nanoseconds(message.header.stamp) for message in messages]
    if 0 in stamps_ns:
        _fail('a stamp of 0')
    if _come_in_pairs(recording, stamps_ns):
        fail(expected=EXPECTED, seen='two messages at once with the same stamp', hint=ONCE)
    if not _advance(recording, stamps_ns):
        _fail('a stamp that does not advance')
    offs = _offs(recording, stamps_ns)
    most, usual = MOST_OFF_SEC[recording.clock], statistics.median_low(offs)
    # a few late messages are tolerated up to `most`, but not if the median is a period behind
    late = [off for off in offs if abs(off) > most]
    wrong = [usual] if abs(usual) > USUAL_OFF_SEC else late
    sent = [sample.source_time_sec for sample in recording.messages]
    from_wall = [abs(ns / 1e9 - at) for ns, at in zip(stamps_ns, sent, strict=True)]
    is_wall = statistics.median(from_wall) <= USUAL_OFF_SEC
    # if all are wrong, compare the median, because one of them may also have been sent late
    is_told = is_wall if wrong == [usual] else max(from_wall) <= USUAL_OFF_SEC
    if wrong and recording.clock == 'simulated' and is_told:
        fail_computer()
    doubt = Starved if wrong == late and recording.was_busy else CheckFailed
    for off in wrong:
        _fail(f'a stamp {abs(off):.1f} s {"ahead of" if off > 0.0 else "behind"} it', doubt)
    # on a busy machine, the driven clock may show the computer's time by chance
    if may_look_again and is_wall:
        expect_to_follow(recording.topic_name, type(messages[0]), recording.publishers)


def _come_in_pairs(recording: RecordedMessages, stamps_ns: Sequence[int]) -> bool:
    """Whether messages come in pairs with one stamp each.

    On the robot's clock, they must also be equal: different messages of one tick share a stamp.
    """
    on_wall = recording.clock == 'wall'
    apart = [
        later.time_sec - earlier.time_sec
        for (earlier, later), (stamp, after) in zip(
            itertools.pairwise(recording.messages), itertools.pairwise(stamps_ns), strict=True
        )
        if stamp == after and (on_wall or _are_alike(earlier.message, later.message))
    ]
    # the median, because a busy machine delays the second message of some pairs
    return bool(apart) and statistics.median(apart) < AT_ONCE_SEC


def _are_alike(message: Any, other: Any) -> bool:
    return content(message) == content(other)


def _advance(recording: RecordedMessages, stamps_ns: Sequence[int]) -> bool:
    sent = [sample.time_sec for sample in recording.messages]
    is_driven = recording.clock == 'simulated'
    return all(
        stamp < after or (stamp == after and is_driven and earlier == later)
        for (stamp, after), (earlier, later) in zip(
            itertools.pairwise(stamps_ns), itertools.pairwise(sent), strict=True
        )
    )


def _offs(recording: RecordedMessages, stamps_ns: Sequence[int]) -> list[float]:
    on_wall = recording.clock == 'wall'
    sent = [
        sample.source_time_sec if on_wall else recording.start_sec + sample.time_sec
        for sample in recording.messages
    ]
    return [stamp_ns / 1e9 - at for stamp_ns, at in zip(stamps_ns, sent, strict=True)]


def _fail(seen: str, doubt: type[CheckFailed] = CheckFailed) -> NoReturn:
    fail(expected=EXPECTED, seen=seen, hint=HOW, cause=f'they have {seen}', doubt=doubt)
