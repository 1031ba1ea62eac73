"""The steps of the resident process: take in, give turns, have graded, store and release."""

import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from pathlib import Path

from grader.collect.collect import EARLIER
from grader.common.errors import CourseError
from grader.common.parsing import ParsingFailed
from grader.common.text import printable
from grader.course import Course
from grader.grading import GradedSubmission, Grading, PreparedAssignment
from grader.report.feedback import FeedbackPage, page_exporter, write_page
from grader.serving.exchange import release_page
from grader.serving.inbound import new_entries
from grader.serving.intake import discard, put_in_place, secret_of, take_in
from grader.serving.queue import (
    FAILED,
    GRADED,
    GRADING,
    REFUSED,
    REPLACED,
    WAITING,
    Arrival,
    Queue,
)
from grader.serving.turns import next_turn, replaced_by
from grader.storage.deadlines import FILE, Deadlines, deadlines
from grader.storage.submitted import SubmissionFolder


@dataclass
class Desk:
    """All that the resident process has at hand."""

    course: Course
    queue: Queue
    grading: Grading
    inbound: Path
    feedback: Path | None
    """The exchange's folder for pages, if there is one."""
    say: Callable[[str], None]
    seen: dict[str, str] = field(default_factory=dict)
    running: dict['Future[GradedSubmission]', Arrival] = field(default_factory=dict)
    prepared: dict[str, tuple[object, PreparedAssignment]] = field(default_factory=dict)
    exporter: FeedbackPage = field(default_factory=page_exporter)


def look(desk: Desk) -> bool:
    """Take in what is new in the inbound folder; return whether there was anything."""
    entries = list(new_entries(desk.inbound, desk.seen))
    for entry in entries:
        for arrival in take_in(desk.course, desk.queue, desk.inbound, entry):
            if arrival.state == REFUSED:
                desk.say(printable(f'not taken, look at it: {arrival.entry}: {arrival.reason}'))
            else:
                desk.say(f'taken in: {_shown(arrival)}')
        desk.seen[entry.name] = entry.fingerprint
    return bool(entries)


def begin_turns(desk: Desk) -> bool:
    """Start to grade whose turn it is, as many as there is room for; return whether any was."""
    started = False
    rules = (deadlines(desk.course.gradebook) or Deadlines()).resubmissions
    while len(desk.running) < desk.grading.backend.capacity:
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
    """Put a submission in its place, keep those that it replaces, and have it graded."""
    outcome, reason = put_in_place(desk.course, arrival)
    for each in earlier:
        put_in_place(desk.course, each)
    reason_of_earlier = 'a later one was graded in its place; it is in submitted_before/'
    ended = [replace(each, state=REPLACED, reason=reason_of_earlier) for each in earlier]
    if outcome == EARLIER:
        ended.append(replace(arrival, state=REPLACED, reason=reason, started=0.0))
    else:
        desk.queue.update(arrival)
        found = SubmissionFolder(
            arrival.student_id,
            arrival.assignment,
            desk.course.folder('submitted', arrival.student_id, arrival.assignment),
        )
        desk.running[_start(desk, found)] = arrival
    desk.queue.update(*ended)
    discard(desk.course, ended)
    for each in ended:
        desk.say(f'replaced: {_shown(each)}: {each.reason}')


def finish_done(desk: Desk) -> bool:
    """Store what is graded, write and release its feedback; return whether there was any."""
    done = [work for work in desk.running if work.done()]
    for work in done:
        finish(desk, desk.running.pop(work), work)
    return bool(done)


def finish(desk: Desk, arrival: Arrival, work: 'Future[GradedSubmission]') -> None:
    """Store one result; its page is released before it counts as done."""
    folder = desk.course.folder('submitted', arrival.student_id, arrival.assignment)
    found = SubmissionFolder(arrival.student_id, arrival.assignment, folder)
    outcome = desk.grading.store(found, work)
    now = time.time()
    if outcome.stored is None:
        ended = replace(arrival, state=FAILED, reason=outcome.reason, ended=now)
        desk.say(f'not graded: {_shown(ended)}: {printable(ended.reason)}')
    else:
        reason = _release(desk, arrival)
        score, most = outcome.stored.score, outcome.stored.max_score
        ended = replace(
            arrival, state=GRADED, reason=reason, ended=time.time(), score=score, max_score=most
        )
        seconds = ended.ended - ended.arrived
        desk.say(f'graded: {_shown(ended)}: {score:g} of {most:g}, {seconds:.1f} s after it came')
        if reason:
            desk.say(f'no feedback: {_shown(ended)}: {reason}')
    desk.queue.update(ended)
    discard(desk.course, [ended])


def _release(desk: Desk, arrival: Arrival) -> str:
    """Write a page, and put it into the exchange; return why there is none, if that is so."""
    try:
        page, _ = write_page(desk.course, *arrival.whose, desk.exporter)
    except ParsingFailed as why:
        return f'no page can be made, for {why}'
    if desk.feedback and (secret := secret_of(desk.course, arrival)):
        release_page(page, desk.feedback, secret=secret, notebook=arrival.assignment)
    return ''


def _start(desk: Desk, found: SubmissionFolder) -> 'Future[GradedSubmission]':
    try:
        return desk.grading.start(found, _prepared(desk, found.assignment))
    except (
        OSError,
        CourseError,
    ) as error:  # its result says so, and the next one is not concerned
        failed: Future[GradedSubmission] = Future()
        failed.set_exception(error)
        return failed


def _prepared(desk: Desk, assignment: str) -> PreparedAssignment:
    """Return what an assignment is graded by; once more where its lesson or the rules changed."""
    course = desk.course
    paths = (course.source_path(assignment), course.release_path(assignment))
    now = [each.stat().st_mtime_ns for each in (*paths, course.gradebook / FILE) if each.exists()]
    before, prepared = desk.prepared.get(assignment, (None, None))
    if prepared is None or before != now:
        prepared = desk.grading.prepare(assignment)
        desk.prepared[assignment] = (now, prepared)
    return prepared


def _shown(arrival: Arrival) -> str:
    return printable(f'{arrival.assignment} of {arrival.student_id}')
