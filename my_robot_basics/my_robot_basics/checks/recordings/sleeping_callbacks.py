"""A sleep in a callback: name it if a node is too slow, and wait no longer on a busy machine.

A sleep is as long on a busy machine as on any other, and there free time is shorter: by free time
alone, what comes after a long sleep would be in time on a busy machine only.
"""

import itertools
import time
from collections.abc import Callable, Iterable, Iterator

from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages
from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.session.pressure import free_turns

ASLEEP_SEC, LOOK_EVERY_SEC = 0.2, 0.3
"""For how long a callback has to sleep on, and how often the notebook is asked; in wall time."""
Names = Callable[[], Iterable[str]]
"""Returns the full names of nodes."""


def why_too_slow(recording: RecordedMessages, wanted_hz: float) -> str:
    """What to try if a callback sleeps, and the rate is too low; '' if that is not the cause.

    On the robot's clock, each tick waits for callbacks: there, the cause is another one.
    """
    if recording.clock != 'wall' or recording.rate_hz >= wanted_hz:
        return ''
    number, text = node_troubles.sleeping_line()
    if not text:
        return ''
    line_number, call = map(student_text, (number, text))
    return (
        f'a callback sleeps in line {line_number} ({call}), and meanwhile the timer cannot call '
        'anything: leave the sleep out'
    )


def or_sleeps(done: Callable[[], bool], after_sec: float, names: Names) -> Callable[[], bool]:
    """Return a function: whether `done()`, or a callback still sleeps `after_sec` from now on.

    Use it for a wait of free time; `after_sec` is wall time.
    """
    next_sec = time.monotonic() + after_sec

    def is_over() -> bool:
        nonlocal next_sec
        if done():
            return True
        if time.monotonic() < next_sec:
            return False
        sleeps = any(node_troubles.sleeps_on(name, ASLEEP_SEC)[1] for name in names())
        next_sec = time.monotonic() + LOOK_EVERY_SEC
        return sleeps

    return is_over


def awake_turns(free_sec: float, names: Names) -> Iterator[int]:
    """As `free_turns`, but end if a callback still sleeps after `free_sec` of wall time."""
    sleeps = or_sleeps(lambda: False, free_sec, names)
    return itertools.takewhile(lambda _: not sleeps(), free_turns(free_sec))
