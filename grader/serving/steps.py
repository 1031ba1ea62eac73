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
from grader.serving.intake import put_in_place, remove_copies, secret_of
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
from grader.serving.turns import next_turn, replaced_by
from grader.serving.unexpected_errors import affects_all_submissions, log_unexpected_error
from grader.storage.deadlines import FILE, Deadlines, deadlines
from grader.storage.failures import raise_gradebook_errors
from grader.storage.submitted import SubmissionFolder

BUDGET_SEC = 0.5
"""How long replaced submissions are stored before gradings go on; one may take longer."""
_LATER = 'a later one was graded in its place; it is in submitted_before/'


@dataclass
class ServingState:
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
    folder = serving.course.folder('submitted', *arrival.submission_key)
    found = SubmissionFolder(*arrival.submission_key, folder)
    serving.running[_start(serving, found)] = arrival


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


def store_finished(serving: ServingState) -> bool:
    """Store finished gradings, write and release feedback; return whether there was any."""
    done = [work for work in serving.running if work.done()]
    for work in done:
        store_result(serving, serving.running.pop(work), work)
    return bool(done)


def store_result(
    serving: ServingState, arrival: Arrival, work: 'Future[GradedSubmission]'
) -> None:
    """Store one result; its feedback page is released before it counts as graded."""
    folder = serving.course.folder('submitted', *arrival.submission_key)
    found = SubmissionFolder(*arrival.submission_key, folder)
    outcome = serving.grading.store(found, work)
    name, now = arrival.printable_name, time.time()
    if outcome.stored is None:
        ended = replace(arrival, state=FAILED, reason=outcome.reason, ended=now)
        serving.say(f'not graded: {name}: {printable(ended.reason)}')
    else:
        reason = _release(serving, arrival)
        score, most = outcome.stored.score, outcome.stored.max_score
        ended = replace(
            arrival, state=GRADED, reason=reason, ended=time.time(), score=score, max_score=most
        )
        seconds = ended.ended - ended.arrived
        serving.say(f'graded: {name}: {score:g} of {most:g}, {seconds:.1f} s after it came')
        if reason:
            serving.say(printable(f'no feedback: {name}: {reason}'))
    serving.queue.update(ended)
    remove_copies(serving.course, [ended])


def _release(serving: ServingState, arrival: Arrival) -> str:
    """Write a feedback page, and put it into the exchange; return why that failed, or ''."""
    try:
        with raise_gradebook_errors(serving.course):
            page, _ = write_page(serving.course, *arrival.submission_key, serving.exporter)
        if serving.feedback and (secret := secret_of(serving.course, arrival)):
            release_page(page, serving.feedback, secret=secret, notebook=arrival.assignment)
    except ParsingFailed as why:
        return f'no page can be made: {why}'
    except Exception as error:
        if affects_all_submissions(error):
            raise
        return f'no page can be made: {log_unexpected_error(arrival.printable_name, error)}'
    return ''


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


def _start(serving: ServingState, found: SubmissionFolder) -> 'Future[GradedSubmission]':
    try:
        return serving.grading.start(found, _prepared(serving, found.assignment))
    except Exception as error:  # becomes the result of this submission; others are not affected
        failed: Future[GradedSubmission] = Future()
        failed.set_exception(error)
        return failed


def _prepared(serving: ServingState, assignment: str) -> PreparedAssignment:
    """Return the prepared assignment; prepare it again if the lesson or the rules changed."""
    course = serving.course
    paths = (course.source_path(assignment), course.release_path(assignment))
    now = [each.stat().st_mtime_ns for each in (*paths, course.gradebook / FILE) if each.exists()]
    before, prepared = serving.prepared.get(assignment, (None, None))
    if prepared is None or before != now:
        prepared = serving.grading.prepare(assignment)
        serving.prepared[assignment] = (now, prepared)
    return prepared
