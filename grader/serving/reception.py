"""Take in new entries, a little at a time; their owners take turns."""

import time
from collections.abc import Mapping, Sequence

from grader.common.text import printable
from grader.serving.desk import Desk, shown
from grader.serving.inbound import Entry, new_entries
from grader.serving.intake import refuse, take_in
from grader.serving.queue import REFUSED, Arrival
from grader.serving.trouble import meets_all, noted

BUDGET_SEC = 0.5
"""How long entries are taken in before gradings go on; one may take longer."""


def look(desk: Desk) -> bool:
    """Take in some new entries of the inbound folder; return whether there were any."""
    waiting = list(new_entries(desk.inbound, desk.seen, desk.rounds))
    end, found = time.monotonic() + BUDGET_SEC, bool(waiting)
    if found:
        desk.rounds.begin()
    while waiting:
        entry = next_entry(waiting, desk.last_taken)
        waiting.remove(entry)
        for arrival in _arrivals(desk, entry):
            if arrival.state == REFUSED:
                desk.say(printable(f'not taken, look at it: {arrival.entry}: {arrival.reason}'))
            else:
                desk.say(f'taken in: {shown(arrival)}')
        desk.seen[entry.key] = entry.fingerprint
        desk.last_taken[entry.owner] = time.time()
        if time.monotonic() >= end:
            break
    return found


def next_entry(waiting: Sequence[Entry], last: Mapping[str, float]) -> Entry:
    """Return the entry to take in next: the oldest, by the later of its time and its owner's turn.

    So a second entry of the same owner does not overtake older entries of others.
    """
    return min(
        waiting,
        key=lambda each: (
            max(each.changed.timestamp(), last.get(each.owner, 0.0)),
            each.changed,
            each.name,
        ),
    )


def _arrivals(desk: Desk, entry: Entry) -> list[Arrival]:
    """Record what an entry contains; an error with this entry alone is why it is refused."""
    if entry.problem:
        return refuse(desk.queue, entry, entry.problem)
    try:
        return take_in(desk.course, desk.queue, desk.inbound, entry)
    except Exception as error:
        if meets_all(error):
            raise
        return refuse(desk.queue, entry, noted(entry.name, error))
