"""The steps of the resident process: start gradings in turn, store results, release feedback."""

import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from pathlib import Path

from grader.collect.collect import EARLIER
from grader.common.parsing import ParsingFailed
from grader.common.text import printable
from grader.course import Course
from grader.grading import GradedSubmission, Grading, PreparedAssignment
from grader.report.feedback import FeedbackPage, page_exporter, write_page
from grader.serving.exchange import release_page
from grader.serving.intake import discard, put_in_place, secret_of
from grader.serving.queue import (
    FAILED,
    GRADED,
    GRADING,
    KEEPING,
    REFUSED,
    REPLACED,
    WAITING,
    Arrival,
    Queue,
)
from grader.serving.rounds import Rounds
from grader.serving.trouble import meets_all, noted
from grader.serving.turns import next_turn, replaced_by
from grader.storage.deadlines import FILE, Deadlines, deadlines
from grader.storage.failures import in_sentences
from grader.storage.submitted import SubmissionFolder

BUDGET_SEC = 0.5
"""How long replaced submissions are stored before gradings go on; one may take longer."""
_LATER = 'a later one was graded in its place; it is in submitted_before/'


@dataclass
class Desk:
    """The state of the resident process."""

    course: Course
    queue: Queue
    grading: Grading
    inbound: Path
    feedback: Path | None
    """The exchange's folder for feedback pages, if there is one."""
    say: Callable[[str], None]
    seen: dict[str, str] = field(default_factory=dict)
    last_taken: dict[str, float] = field(default_factory=dict)
    """When an entry of each owner was last taken in from the inbound folder, in Unix time."""
    rounds: Rounds = field(default_factory=Rounds)
    running: dict['Future[GradedSubmission]', Arrival] = field(default_factory=dict)
    prepared: dict[str, tuple[object, PreparedAssignment]] = field(default_factory=dict)
    exporter: FeedbackPage = field(default_factory=page_exporter)


def begin_turns(desk: Desk) -> bool:
    """Start as many gradings as there is room for; return whether there was any turn.

    A turn counts even if it does not lead to a grading.
    """
    started = False
    rules = (deadlines(desk.course.gradebook) or Deadlines()).resubmissions
    for _ in range(desk.grading.backend.capacity - len(desk.running)):
        if not (waiting := desk.queue.find(WAITING)):
            break
        busy = {each.student_id for each in desk.running.values()}
        now = time.time()
        turn = next_turn(waiting, busy, desk.queue.starts(), rules, now)
        if turn is None:
            break
        started = True
        begin(desk, replace(turn, state=GRADING, started=now), replaced_by(turn, waiting))
    return started


def begin(desk: Desk, arrival: Arrival, earlier: list[Arrival]) -> None:
    """Put a submission in its place and have it graded; the ones it replaces are kept later."""
    outcome, reason = _put(desk, arrival)
    if outcome == REFUSED:  # then an earlier submission gets its turn
        _end(desk, replace(arrival, state=REFUSED, reason=reason, started=0.0))
        return
    desk.queue.update(*(replace(each, state=KEEPING) for each in earlier))
    if outcome == EARLIER:
        _end(desk, replace(arrival, state=REPLACED, reason=reason, started=0.0))
        return
    desk.queue.update(arrival)
    found = SubmissionFolder(
        arrival.student_id,
        arrival.assignment,
        desk.course.folder('submitted', arrival.student_id, arrival.assignment),
    )
    desk.running[_start(desk, found)] = arrival


def keep_replaced(desk: Desk) -> bool:
    """Store some of the submissions that a later one replaced; return whether there was any."""
    found = desk.queue.find(KEEPING)
    end = time.monotonic() + BUDGET_SEC
    for each in found:
        outcome, reason = _put(desk, each)
        state = REFUSED if outcome == REFUSED else REPLACED
        _end(desk, replace(each, state=state, reason=reason if state == REFUSED else _LATER))
        if time.monotonic() >= end:
            break
    return bool(found)


def finish_done(desk: Desk) -> bool:
    """Store finished gradings, write and release feedback; return whether there was any."""
    done = [work for work in desk.running if work.done()]
    for work in done:
        finish(desk, desk.running.pop(work), work)
    return bool(done)


def finish(desk: Desk, arrival: Arrival, work: 'Future[GradedSubmission]') -> None:
    """Store one result; its feedback page is released before it counts as graded."""
    folder = desk.course.folder('submitted', arrival.student_id, arrival.assignment)
    found = SubmissionFolder(arrival.student_id, arrival.assignment, folder)
    outcome = desk.grading.store(found, work)
    now = time.time()
    if outcome.stored is None:
        ended = replace(arrival, state=FAILED, reason=outcome.reason, ended=now)
        desk.say(f'not graded: {shown(ended)}: {printable(ended.reason)}')
    else:
        reason = _release(desk, arrival)
        score, most = outcome.stored.score, outcome.stored.max_score
        ended = replace(
            arrival, state=GRADED, reason=reason, ended=time.time(), score=score, max_score=most
        )
        seconds = ended.ended - ended.arrived
        desk.say(f'graded: {shown(ended)}: {score:g} of {most:g}, {seconds:.1f} s after it came')
        if reason:
            desk.say(printable(f'no feedback: {shown(ended)}: {reason}'))
    desk.queue.update(ended)
    discard(desk.course, [ended])


def _release(desk: Desk, arrival: Arrival) -> str:
    """Write a feedback page, and put it into the exchange; return why that failed, or ''."""
    try:
        with in_sentences(desk.course):
            page, _ = write_page(desk.course, *arrival.whose, desk.exporter)
        if desk.feedback and (secret := secret_of(desk.course, arrival)):
            release_page(page, desk.feedback, secret=secret, notebook=arrival.assignment)
    except ParsingFailed as why:
        return f'no page can be made: {why}'
    except Exception as error:
        if meets_all(error):
            raise
        return f'no page can be made: {noted(shown(arrival), error)}'
    return ''


def _put(desk: Desk, arrival: Arrival) -> tuple[str, str]:
    """Put a submission where it is graded; return the outcome (REFUSED on errors) and why."""
    try:
        return put_in_place(desk.course, arrival)
    except Exception as error:
        if meets_all(error):
            raise
        return REFUSED, noted(shown(arrival), error)


def _end(desk: Desk, ended: Arrival) -> None:
    """Record that a submission is not graded, and print why."""
    desk.queue.update(ended)
    discard(desk.course, [ended])
    what = 'not taken, look at it' if ended.state == REFUSED else 'replaced'
    desk.say(printable(f'{what}: {shown(ended)}: {ended.reason}'))


def _start(desk: Desk, found: SubmissionFolder) -> 'Future[GradedSubmission]':
    try:
        return desk.grading.start(found, _prepared(desk, found.assignment))
    except Exception as error:  # becomes the result of this submission; others are not affected
        failed: Future[GradedSubmission] = Future()
        failed.set_exception(error)
        return failed


def _prepared(desk: Desk, assignment: str) -> PreparedAssignment:
    """Return the prepared assignment; prepare it again if the lesson or the rules changed."""
    course = desk.course
    paths = (course.source_path(assignment), course.release_path(assignment))
    now = [each.stat().st_mtime_ns for each in (*paths, course.gradebook / FILE) if each.exists()]
    before, prepared = desk.prepared.get(assignment, (None, None))
    if prepared is None or before != now:
        prepared = desk.grading.prepare(assignment)
        desk.prepared[assignment] = (now, prepared)
    return prepared


def shown(arrival: Arrival) -> str:
    """Return how messages name a submission."""
    return printable(f'{arrival.assignment} of {arrival.student_id}')
