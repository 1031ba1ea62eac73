"""Keep the last recording, so that the next check of the exercise need not record again.

This is done only in the test's room, where no student's cell runs between two checks, and only
while checks only subscribe. A recording serves checks that want no more of the robot's time,
unless the messages had ended, or a busy machine forced the check onto the wall clock. On the wall
clock, all recordings are equally long; a check that wants more looks whether the node goes on.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.checks.recordings import rates
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.feedback.errors import CheckFailed
from my_robot_basics.feedback.hidden import is_in_test_room
from my_robot_basics.session import interactions


@dataclass(frozen=True)
class Wanted:
    """The recording that a check wants."""

    topic_name: str
    seconds: float
    """How long, in the robot's time."""
    step_sec: float
    """The step of the robot's clock."""


@dataclass(frozen=True)
class Look:
    """A recording, and why it was not made on the robot's clock, if it was not."""

    recording: Recording
    why: Inconclusive | None


@dataclass(frozen=True)
class _Kept:
    wanted: Wanted
    look: Look | CheckFailed
    interactions: int


_last: _Kept | None = None


def look_once(wanted: Wanted, look: Callable[[Look | None], Look]) -> Look:
    """Return the last look if it serves `wanted`, else what `look` returns.

    `look` gets the last look if that was on the wall clock and shorter than wanted, else None.
    Raises CheckFailed if there is nothing to record; the next time in the same words.
    """
    global _last
    if _last is not None and _serves(_last, wanted):
        return _reused_look(_last.look, wanted.seconds)
    earlier, _last = _on_wall(_last, wanted), None
    try:
        found = look(earlier)
    except CheckFailed as failure:
        # other classes say that the answer may not be the cause: then new rooms take a second look
        if type(failure) is CheckFailed and failure.repeat is not None:
            _last = _Kept(wanted, failure, interactions.count())
        raise
    _last = _Kept(wanted, found, interactions.count())
    return found


def _serves(kept: _Kept, wanted: Wanted) -> bool:
    if not _is_of_the_same(kept, wanted):
        return False
    if isinstance(kept.look, CheckFailed):
        return True
    return _is_whole(kept.look.recording) and wanted.seconds <= kept.wanted.seconds


def _on_wall(kept: _Kept | None, wanted: Wanted) -> Look | None:
    if kept is None or isinstance(kept.look, CheckFailed) or not _is_of_the_same(kept, wanted):
        return None
    recording = kept.look.recording
    return kept.look if recording.clock == 'wall' and _is_whole(recording) else None


def _is_of_the_same(kept: _Kept, wanted: Wanted) -> bool:
    if not is_in_test_room() or kept.interactions != interactions.count():
        return False
    return replace(wanted, seconds=kept.wanted.seconds) == kept.wanted


def _is_whole(recording: Recording) -> bool:
    return not recording.is_makeshift and not recording.has_ended


def _reused_look(look: Look | CheckFailed, seconds: float) -> Look:
    if isinstance(look, CheckFailed):
        assert look.repeat is not None  # look_once keeps only failures that can be repeated
        look.repeat()
    if look.recording.clock == 'wall':
        return look
    return replace(look, recording=_beginning(look.recording, seconds))


def _beginning(recording: Recording, seconds: float) -> Recording:
    """The first `seconds` of a recording, or its first FEWEST messages if these take longer."""
    messages = recording.messages
    inside = sum(sample.time_sec <= seconds for sample in messages)
    kept = messages[: max(inside, rates.FEWEST)]
    until_sec = max(seconds, kept[-1].time_sec)
    return replace(recording, messages=kept, seconds=min(until_sec, recording.seconds))
