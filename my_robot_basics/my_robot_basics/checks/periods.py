"""What the times at which messages were sent tell of the timer, or of the loop, behind them.

All of them take `times_sec`: an array of seconds, ascending, of the message to begin at and of
those that came after it.
"""

from typing import NamedTuple

import numpy as np

MOST_TIMES = 3_000
"""So many of the first are compared, each with each: a minute at 50 Hz. A timer with a period of 0
sends so many in a second, and all of them would take gigabytes."""
FEWEST_GAPS = 8
"""So many gaps between messages tell a timer from a loop; fewer have their mean alone."""
FLOOR_PART = 0.01
"""A loop that sleeps is late and never early: its shortest gaps are that near to each other."""
MOST_TURNS = 4
"""Two, three or four gaps that come again and again are looked for …"""
FEWEST_ROUNDS = 3
"""… And have to come so many times."""
TURNS_PART = 0.15
"""Alternating gaps differ by this part of a period; a busy machine has no such order."""
SHUFFLES = 50
"""So many other orders of the same gaps are tried: each is more even."""
FEWEST_LEFT_OUT = 3
"""Messages that are missing at equal distances: no thread is late so evenly."""
TOO_MANY_TIMES, PARTS = 1.25, 4
"""So many times as many messages as there should be, in each of so many parts of a recording."""
SHORTEST_ROUND = 3
"""Gaps from one missing message to the next: two that alternate may be anything."""


def spanned(times_sec: np.ndarray, slack_sec: float) -> tuple[float, float]:
    """The least and the greatest period, in seconds, of a timer that explains all of the times.

    Each may be late by `slack_sec`. The least is above the greatest where none explains them.
    """
    lengths, apart = _pairs(times_sec)
    # each pair of arrivals leaves the period a range; they must all agree on one
    low, high = (lengths - slack_sec) / apart, (lengths + slack_sec) / apart
    return float(np.max(low)), float(np.min(high))


def meant(times_sec: np.ndarray) -> float:
    """The period, in seconds, that a timer or a loop was given, however late it is now and then.

    A timer keeps to its grid: the median slope over all pairs of messages is hardly moved by
    late ones. A loop that sleeps begins anew with each message, so that each delay stays: its
    period is the shortest gap that comes often.
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
    """How long, and how many messages, two of them are apart: each pair of the first ones."""
    first = times_sec[:MOST_TIMES]
    earlier, later = np.triu_indices(len(first), k=1)
    return first[later] - first[earlier], later - earlier


def come_by_turns(times_sec: np.ndarray, slack_sec: float = 0.0) -> bool:
    """Whether long and short gaps take turns: every second one, every third or every fourth.

    Most of the long ones have to be longer than most of the short ones, by more than
    `slack_sec`, and by more than in any other order of the same gaps: what a busy machine does
    to them has none.
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
    """How much longer most of the longest of `count` turns are than most of the shortest."""
    turns = sorted((gaps[first::count] for first in range(count)), key=np.median)
    return float(np.quantile(turns[-1], 0.25) - np.quantile(turns[0], 0.75))


def come_too_often(times_sec: np.ndarray, hz: float, *, seconds: float) -> bool:
    """Whether more messages came than `hz` times a second, and all through `seconds`.

    A node that was kept waiting may send late ones at once, but goes on to send no more.
    """
    counts, _ = np.histogram(times_sec[1:], bins=PARTS, range=(0.0, seconds))
    return bool(np.min(counts) > TOO_MANY_TIMES * hz * seconds / PARTS + 1)


def left_out(times_sec: np.ndarray, slack_sec: float) -> int:
    """Which message of a timer is left out again and again: 10 for every tenth; 0 for none.

    One period explains all that came, each late by `slack_sec` at most, and what is missing is
    missing evenly.
    """
    times_sec = times_sec[:MOST_TIMES]
    gaps = np.diff(times_sec)
    if len(gaps) < FEWEST_GAPS or not np.median(gaps):  # messages of a burst have one time
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
    """Messages that come in the same ticks of the robot's clock again and again."""

    size: int
    """How many of them."""
    cycle_sec: float
    """After so long they come again."""
    is_burst: bool
    """Whether they come in one tick."""


def pattern_of(times_sec: np.ndarray, step_sec: float, *, seconds: float) -> Pattern | None:
    """The shortest pattern of two messages or more that all of `seconds` are made of, or None.

    `step_sec`: how far a tick moved the clock.
    """
    ticks = np.rint(times_sec[1:] / step_sec).astype(int)
    counts = np.bincount(ticks, minlength=round(seconds / step_sec) + 1)[1:]
    for cycle in range(1, len(counts) // FEWEST_ROUNDS + 1):
        if np.array_equal(counts[cycle:], counts[:-cycle]):
            size = int(np.sum(counts[:cycle]))
            is_burst = np.count_nonzero(counts[:cycle]) == 1
            return Pattern(size, cycle * step_sec, bool(is_burst)) if size > 1 else None
    return None
