"""The whole flow: read a submission, restore it, run and judge it, store what came of it."""

from collections.abc import Generator, Sequence
from concurrent.futures import Future

from grader.common.errors import CourseError
from grader.common.futures import run_ahead
from grader.course import Course
from grader.grading import GradedSubmission, Grading, PreparedAssignment, SubmissionOutcome
from grader.storage.backups import bring_in_order
from grader.storage.database import one_engine
from grader.storage.deadlines import deadlines
from grader.storage.failures import in_sentences
from grader.storage.lock import gradebook_lock
from grader.storage.submitted import SubmissionFolder, is_new
from grader.workers.backend import Backend
from grader.workers.workers import Workers

AHEAD = 4
"""How many times more submissions may be done and wait for a slower one before them."""


def grade_all(
    course: Course,
    submissions: Sequence[SubmissionFolder],
    *,
    backend: Backend | None = None,
    seed: str = '',
    trust_students: bool = False,
    force: bool = False,
) -> Generator[SubmissionOutcome, None, None]:
    """Read, restore, run, judge and store submissions, many at a time, in their order.

    Each gets its row, whatever becomes of it. The backend is this machine's worker processes
    unless another is given. `seed` replays inputs that hidden tests choose; by default they are
    each student's own. Doing it again gives the same; where nothing has changed the stored result
    holds, unless told to `force` a new one. Raises CourseError, and runs nothing, where there is
    no sandbox, unless told to `trust_students`.
    """
    with backend or Workers() as backend:
        isolated = backend.require_isolation(trust_students=trust_students)
        if force or any(is_new(course, each) for each in submissions):
            backend.begin()  # it gets ready while lessons and submissions are read
        grading = Grading(course, backend, isolated, seed, trust_students, force)
        assignments = _prepare(grading, submissions)

        def start(found: SubmissionFolder) -> 'Future[GradedSubmission]':
            if found.problem:
                raise CourseError(found.problem)
            return grading.start(found, assignments[found.assignment])

        with one_engine(course.db_url):
            for found, work in run_ahead(submissions, start, at_most=AHEAD * backend.capacity):
                yield grading.store(found, work)


def _prepare(
    grading: Grading, submissions: Sequence[SubmissionFolder]
) -> dict[str, PreparedAssignment]:
    """Bring the gradebook in order, and return what each assignment is graded by."""
    course = grading.course
    deadlines(course.gradebook, course.assignments())  # what is wrong with them is said now
    with in_sentences(course), gradebook_lock(course.gradebook):
        bring_in_order(course)
        names = sorted({each.assignment for each in submissions if not each.problem})
        return {name: grading.prepare(name) for name in names}
