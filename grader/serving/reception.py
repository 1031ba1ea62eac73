"""Take in new entries, a little at a time; their owners take turns."""

import time
from collections.abc import Mapping, Sequence

from grader.common.text import printable
from grader.serving.inbound import Entry, new_entries
from grader.serving.intake import refuse, take_in
from grader.serving.queue import REFUSED, Arrival
from grader.serving.state import ServingState
from grader.serving.unexpected_errors import affects_all_submissions, log_unexpected_error

BUDGET_SEC = 0.5
"""How long entries are taken in before gradings go on; one may take longer."""


def take_in_new_entries(serving: ServingState) -> bool:
    """Take in some new entries of the inbound folder; return whether there were any."""
    waiting = list(new_entries(serving.inbound, serving.seen, serving.rounds))
    end, found = time.monotonic() + BUDGET_SEC, bool(waiting)
    if found:
        serving.rounds.begin()
    while waiting:
        entry = next_entry(waiting, serving.last_taken)
        waiting.remove(entry)
        for arrival in _take_in_entry(serving, entry):
            if arrival.state == REFUSED:
                serving.say(printable(f'not taken, look at it: {arrival.entry}: {arrival.reason}'))
            else:
                serving.say(f'taken in: {arrival.printable_name}')
        serving.seen[entry.key] = entry.fingerprint
        serving.last_taken[entry.owner] = time.time()
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


def _take_in_entry(serving: ServingState, entry: Entry) -> list[Arrival]:
    """Record what an entry contains; an error with this entry alone is why it is refused."""
    if entry.problem:
        return refuse(serving.queue, entry, entry.problem)
    try:
        return take_in(serving.course, serving.queue, serving.inbound, entry)
    except Exception as error:
        if affects_all_submissions(error):
            raise
        return refuse(serving.queue, entry, log_unexpected_error(entry.name, error))
