"""Steps of the resident process: start gradings in turn, store submissions that were replaced."""

import time
from dataclasses import replace

from grader.collect.collect import EARLIER
from grader.common.text import printable
from grader.serving.intake import put_in_place, remove_copies
from grader.serving.queue import GRADING, KEEPING, REFUSED, REPLACED, WAITING, Arrival
from grader.serving.state import ServingState, run
from grader.serving.turns import next_turn, replaced_by
from grader.serving.unexpected_errors import affects_all_submissions, log_unexpected_error
from grader.storage.deadlines import Deadlines, deadlines

BUDGET_SEC = 0.5
"""How long replaced submissions are stored before gradings go on; one may take longer."""
_LATER = 'a later one was graded in its place; it is in submitted_before/'


def start_gradings(serving: ServingState) -> bool:
    """Start as many gradings as there is room for; return whether there was any turn.

    A turn counts even if it does not lead to a grading.
    """
    started = False
    rules = (deadlines(serving.course.gradebook) or Deadlines()).resubmissions
    for _ in range(serving.grading.backend.capacity - len(serving.running)):
        if not (waiting := serving.queue.find(WAITING)):
            break
        busy = {each.student_id for each in serving.running.values()}
        now = time.time()
        turn = next_turn(waiting, busy, serving.queue.starts(), rules, now)
        if turn is None:
            break
        started = True
        start_grading(
            serving, replace(turn, state=GRADING, started=now), replaced_by(turn, waiting)
        )
    return started


def start_grading(serving: ServingState, arrival: Arrival, earlier: list[Arrival]) -> None:
    """Put a submission in its place and have it graded; the ones it replaces are kept later."""
    outcome, reason = _put_or_refuse(serving, arrival)
    if outcome == REFUSED:  # then an earlier submission gets its turn
        _end_ungraded(serving, replace(arrival, state=REFUSED, reason=reason, started=0.0))
        return
    serving.queue.update(*(replace(each, state=KEEPING) for each in earlier))
    if outcome == EARLIER:
        _end_ungraded(serving, replace(arrival, state=REPLACED, reason=reason, started=0.0))
        return
    serving.queue.update(arrival)
    run(serving, arrival)


def store_replaced(serving: ServingState) -> bool:
    """Store some of the submissions that a later one replaced; return whether there was any."""
    found = serving.queue.find(KEEPING)
    end = time.monotonic() + BUDGET_SEC
    for each in found:
        outcome, reason = _put_or_refuse(serving, each)
        state = REFUSED if outcome == REFUSED else REPLACED
        _end_ungraded(
            serving, replace(each, state=state, reason=reason if state == REFUSED else _LATER)
        )
        if time.monotonic() >= end:
            break
    return bool(found)


def _put_or_refuse(serving: ServingState, arrival: Arrival) -> tuple[str, str]:
    """Put a submission where it is graded; return the outcome (REFUSED on errors) and why."""
    try:
        return put_in_place(serving.course, arrival)
    except Exception as error:
        if affects_all_submissions(error):
            raise
        return REFUSED, log_unexpected_error(arrival.printable_name, error)


def _end_ungraded(serving: ServingState, ended: Arrival) -> None:
    """Record that a submission is not graded, and print why."""
    serving.queue.update(ended)
    remove_copies(serving.course, [ended])
    what = 'not taken, look at it' if ended.state == REFUSED else 'replaced'
    serving.say(printable(f'{what}: {ended.printable_name}: {ended.reason}'))
