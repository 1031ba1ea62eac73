"""The whole flow: read a submission, restore it, run and judge it, store the result."""

from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import replace

from grader.common.errors import CourseError
from grader.common.futures import run_ahead, started
from grader.course import Course
from grader.grading import GradedSubmission, Grading, PreparedAssignment, SubmissionOutcome
from grader.storage.backups import recover_and_back_up
from grader.storage.database import share_engine
from grader.storage.deadlines import deadlines
from grader.storage.failures import raise_gradebook_errors
from grader.storage.lock import gradebook_lock
from grader.storage.submitted import SubmissionFolder, is_new
from grader.workers.backend import Backend
from grader.workers.workers import Workers

AHEAD = 4
"""Times the backend's capacity: how many finished submissions may wait for a slower one."""
MOST_IN_VAIN = 3
"""So many in a row that stay undecided show that something else keeps the machine busy."""


def grade_all(
    course: Course,
    submissions: Sequence[SubmissionFolder],
    *,
    backend: Backend | None = None,
    seed: str = '',
    trust_students: bool = False,
    force: bool = False,
) -> Generator[SubmissionOutcome, None, None]:
    """Read, restore, run, judge and store submissions, many at a time; yield in their order.

    Each submission gets an outcome, whatever happens. The default backend is this machine's worker
    processes. `seed` replays inputs that hidden tests choose; by default each student has a seed
    of their own. Grading again gives the same result. If nothing has changed, the stored result
    is used again, unless `force`. Those in which a check could not decide are graded again at the
    end, one at a time, and yielded once more, unless its own kernel crashed or hung. Raises
    CourseError, before anything runs, if there is no sandbox, unless `trust_students`.
    """
    with backend or Workers() as backend:
        isolated = backend.require_isolation(trust_students=trust_students)
        if force or any(is_new(course, each) for each in submissions):
            backend.begin()  # workers start while lessons and submissions are read
        grading = Grading(course, backend, isolated, seed, trust_students, force)
        assignments = _prepare(grading, submissions)

        def start(found: SubmissionFolder) -> 'Future[GradedSubmission]':
            if found.problem:
                raise CourseError(found.problem)
            return grading.start(found, assignments[found.assignment])

        undecided = {}
        with share_engine(course.db_url):
            for found, work in run_ahead(submissions, start, at_most=AHEAD * backend.capacity):
                outcome = grading.store(found, work)
                yield outcome
                if outcome.may_be_decided:
                    undecided[found] = outcome
            yield from _grade_again(grading, undecided, start)


def _grade_again(
    grading: Grading,
    undecided: Mapping[SubmissionFolder, SubmissionOutcome],
    start: Callable[[SubmissionFolder], 'Future[GradedSubmission]'],
) -> Generator[SubmissionOutcome, None, None]:
    """Grade undecided submissions with no other beside them; `former` stays that before the run.

    It ends early if MOST_IN_VAIN in a row stay undecided.
    """
    in_vain = 0
    for found, first in undecided.items():
        outcome = grading.store(found, started(start, found))
        if first.stored and outcome.stored:
            outcome = replace(outcome, stored=replace(outcome.stored, former=first.stored.former))
        elif first.stored:  # the first result is still what is stored
            outcome = replace(first, reason=f'{first.reason}; then {outcome.reason}')
        yield replace(outcome, again=True)
        in_vain = in_vain + 1 if outcome.is_undecided else 0
        if in_vain == MOST_IN_VAIN:
            return


def _prepare(
    grading: Grading, submissions: Sequence[SubmissionFolder]
) -> dict[str, PreparedAssignment]:
    """Bring the gradebook in order, and return each assignment prepared for grading."""
    course = grading.course
    deadlines(course.gradebook, course.assignments())  # raises now if the due dates are wrong
    with raise_gradebook_errors(course), gradebook_lock(course.gradebook):
        recover_and_back_up(course)
        names = sorted({each.assignment for each in submissions if not each.problem})
        return {name: grading.prepare(name) for name in names}
