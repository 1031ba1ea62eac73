"""What the times at which messages were sent reveal about the timer or loop that sent them.

All functions take `times_sec`: an ascending array in seconds, first the time of the message at
which the recording begins, then those of the messages after it.
"""

from typing import NamedTuple

import numpy as np

MOST_TIMES = 3_000
"""How many times are compared pairwise: a minute at 50 Hz. A timer with a period of 0 sends as
many in a second, and comparing all of them would take gigabytes of memory."""
FEWEST_GAPS = 8
"""The least number of gaps that can distinguish a timer from a loop; of fewer, the mean counts."""
FLOOR_PART = 0.01
"""A loop that sleeps is often late, never early: its shortest gaps differ by this part at most."""
MOST_TURNS = 4
"""`come_by_turns` looks for sequences of 2 to MOST_TURNS gaps that repeat."""
FEWEST_ROUNDS = 3
"""How often a sequence of gaps, or a pattern, must fit into the recording to count."""
TURNS_PART = 0.15
"""The gaps of a repeating sequence differ by at least this part of the median gap."""
SHUFFLES = 50
"""The gaps are compared with this many random orders of them: in each, they must differ less."""
FEWEST_LEFT_OUT = 3
"""The least number of missing messages at equal distances: no thread is late so regularly."""
TOO_MANY_TIMES, PARTS = 1.25, 4
"""Messages come too often if each of PARTS equal parts of a recording has more than TOO_MANY_TIMES
as many as it should have."""
SHORTEST_ROUND = 3
"""The least number of gaps between two missing messages: two alternating gaps are ambiguous."""


def possible_periods(times_sec: np.ndarray, slack_sec: float) -> tuple[float, float]:
    """The least and the greatest period, in seconds, of a timer that explains all of the times.

    Each time may be off by `slack_sec`. The least is above the greatest if no period does.
    """
    lengths, apart = _pairs(times_sec)
    # each pair of arrivals limits the period to a range; the result is what all ranges share
    low, high = (lengths - slack_sec) / apart, (lengths + slack_sec) / apart
    return float(np.max(low)), float(np.min(high))


def intended_period(times_sec: np.ndarray) -> float:
    """The period, in seconds, that a timer or loop was given, even if some messages were late.

    A timer keeps to its grid, so its period is the median slope over all pairs of messages, which
    late messages hardly change. A loop that sleeps starts again after each message, so delays add
    up: its period is the shortest gap that is frequent (the lower quartile).
    """
    gaps = np.diff(times_sec)
    if len(gaps) < FEWEST_GAPS:
        return float(np.mean(gaps))
    often = float(np.quantile(gaps, 0.25))
    if np.min(gaps) >= (1.0 - FLOOR_PART) * often:
        return often
    lengths, apart = _pairs(times_sec)
    return float(np.median(lengths / apart))


def _pairs(times_sec: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each pair of the first messages: the seconds between them, and how many periods."""
    first = times_sec[:MOST_TIMES]
    earlier, later = np.triu_indices(len(first), k=1)
    return first[later] - first[earlier], later - earlier


def come_by_turns(times_sec: np.ndarray, slack_sec: float = 0.0) -> bool:
    """Whether long and short gaps alternate: every second, third or fourth gap is longer.

    Most long gaps must exceed most short ones by TURNS_PART of the median and `slack_sec`, and by
    more than in random orders of the same gaps: the delays of a busy machine have no order.
    """
    gaps, chance = np.diff(times_sec), np.random.default_rng(0)
    for count in range(2, MOST_TURNS + 1):
        if len(gaps) < FEWEST_ROUNDS * count:
            break
        apart_sec = _apart_by_turns(gaps, count)
        if apart_sec > TURNS_PART * np.median(gaps) + slack_sec and all(
            apart_sec > _apart_by_turns(chance.permutation(gaps), count) for _ in range(SHUFFLES)
        ):
            return True
    return False


def _apart_by_turns(gaps: np.ndarray, count: int) -> float:
    """Group the gaps by their index modulo `count`; how far apart are the extreme groups, in s?

    From the third quartile of the shortest group to the first quartile of the longest one.
    """
    turns = sorted((gaps[first::count] for first in range(count)), key=np.median)
    return float(np.quantile(turns[-1], 0.25) - np.quantile(turns[0], 0.75))


def come_too_often(times_sec: np.ndarray, hz: float, *, seconds: float) -> bool:
    """Whether the rate was above `hz` throughout the `seconds` of a recording.

    A delayed node may send late messages in a burst, but that raises the rate only briefly.
    """
    counts, _ = np.histogram(times_sec[1:], bins=PARTS, range=(0.0, seconds))
    return bool(np.min(counts) > TOO_MANY_TIMES * hz * seconds / PARTS + 1)


def left_out_every(times_sec: np.ndarray, slack_sec: float) -> int:
    """Which message of a timer is missing regularly: 10 for every tenth one; 0 for none.

    One period must explain all messages that came, each off by `slack_sec` at most, and the
    missing ones must be at equal distances.
    """
    times_sec = times_sec[:MOST_TIMES]
    gaps = np.diff(times_sec)
    if len(gaps) < FEWEST_GAPS or not np.median(gaps):  # the messages of a burst have equal times
        return 0
    steps = np.rint(gaps / np.median(gaps)).astype(int)
    missing_at = np.flatnonzero(steps > 1)
    rounds = set(np.diff(missing_at).tolist())
    if np.min(steps) < 1 or len(missing_at) < FEWEST_LEFT_OUT or len(rounds) > 1:
        return 0
    if len(set(steps[missing_at].tolist())) > 1 or min(rounds) < SHORTEST_ROUND:
        return 0
    calls = np.concatenate([[0], np.cumsum(steps)])
    earlier, later = np.triu_indices(len(calls), k=1)
    lengths, apart = times_sec[later] - times_sec[earlier], calls[later] - calls[earlier]
    is_one = np.max((lengths - slack_sec) / apart) <= np.min((lengths + slack_sec) / apart)
    return rounds.pop() + 1 if is_one else 0


class Pattern(NamedTuple):
    """A sequence of messages that repeats at the same ticks of the robot's clock."""

    size: int
    """How many messages it has."""
    cycle_sec: float
    """The time after which it repeats."""
    is_burst: bool
    """Whether all of its messages come in one tick."""


def pattern_of(times_sec: np.ndarray, step_sec: float, *, seconds: float) -> Pattern | None:
    """The shortest pattern that repeats throughout `seconds`; None if there is none.

    A single message that repeats is not a pattern. `step_sec`: how far a tick moved the clock.
    """
    ticks = np.rint(times_sec[1:] / step_sec).astype(int)
    counts = np.bincount(ticks, minlength=round(seconds / step_sec) + 1)[1:]
    for cycle in range(1, len(counts) // FEWEST_ROUNDS + 1):
        if np.array_equal(counts[cycle:], counts[:-cycle]):
            size = int(np.sum(counts[:cycle]))
            is_burst = np.count_nonzero(counts[:cycle]) == 1
            return Pattern(size, cycle * step_sec, bool(is_burst)) if size > 1 else None
    return None
