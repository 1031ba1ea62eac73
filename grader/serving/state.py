"""The state of the resident process, and how a grading starts in it."""

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path

from grader.common.errors import CourseError
from grader.common.futures import started
from grader.common.text import printable
from grader.course import Course
from grader.grading import GradedSubmission, Grading, PreparedAssignment
from grader.report.feedback import FeedbackPage, page_exporter
from grader.serving.queue import Arrival, Queue
from grader.serving.rounds import Rounds
from grader.storage.deadlines import FILE, deadlines
from grader.storage.submitted import SubmissionFolder


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
    pause: str = ''
    """Why nothing is graded now."""


def check_for_pause(serving: ServingState) -> bool:
    """Pause while the due dates can't be read, for no score would be right; return any change.

    It ends as soon as they can be read again.
    """
    before, serving.pause = serving.pause, ''
    try:
        deadlines(serving.course.gradebook)
    except CourseError as error:
        serving.pause = str(error)
    if serving.pause == before:
        return False
    serving.say(f'paused: {printable(serving.pause)}' if serving.pause else 'grading goes on')
    return True


def run(serving: ServingState, arrival: Arrival) -> None:
    """Have the submission graded that is in its place now; an error becomes its result."""

    def start(found: SubmissionFolder) -> 'Future[GradedSubmission]':
        return serving.grading.start(found, _prepared(serving, found.assignment))

    serving.running[started(start, folder_of(serving, arrival))] = arrival


def folder_of(serving: ServingState, arrival: Arrival) -> SubmissionFolder:
    """Return where a submission is graded."""
    folder = serving.course.folder('submitted', *arrival.submission_key)
    return SubmissionFolder(*arrival.submission_key, folder)


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
