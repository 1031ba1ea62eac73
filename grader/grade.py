"""The whole flow: read a submission, restore it, run and judge it, store what came of it."""

import logging
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

from nbformat import NotebookNode

from grader.common.errors import ClusterError, CourseError, GradebookError, TaskFailed
from grader.common.futures import completed, run_ahead, then
from grader.common.text import printable
from grader.course import Course
from grader.judging.task import Result
from grader.notebook.restore import AssignmentTemplate
from grader.notebook.submission import Submission, read_submission
from grader.storage.backups import bring_in_order
from grader.storage.database import in_sentences, one_engine
from grader.storage.gradebook import StoredResult, store
from grader.storage.late_penalties import deadlines
from grader.storage.lock import gradebook_lock
from grader.storage.pipeline import prepared_template
from grader.storage.registering import register
from grader.storage.reuse import (
    conditions,
    find_earlier_result,
    key_of,
    refresh_late_penalty,
    remember,
)
from grader.storage.submitted import SubmissionFolder
from grader.workers.backend import Backend, submit_for_grading
from grader.workers.workers import Workers

AHEAD = 4
"""How many times more submissions may be done and wait for a slower one before them."""


@dataclass(frozen=True)
class GradedSubmission:
    """A submission that was judged, and is not stored yet."""

    submission: Submission
    notebook: NotebookNode
    """With a verdict in each grade cell."""
    seconds: float | None = None
    """How long that took where it ran; None for an earlier result that still holds."""


@dataclass(frozen=True)
class SubmissionOutcome:
    """What the run says of one submission."""

    student_id: str
    assignment: str
    stored: StoredResult | None
    """What the gradebook holds now; None where nothing could be stored."""
    reason: str
    seconds: float | None = None
    """How long it was graded; None where nothing was run."""
    reused: bool = False
    """Whether nothing has changed since, so that the stored result holds."""


@dataclass(frozen=True)
class _PreparedAssignment:
    """What the submissions of one assignment have in common."""

    template: AssignmentTemplate
    seed_of: Callable[[str], str]
    """Gives each student's seed."""
    packages: tuple[str, ...]
    """ROS packages that are handed in with the notebook."""
    conditions: str
    """What else a result depends on, as a hash."""


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
        assignments = _prepare(course, submissions, seed=seed, isolated=isolated)

        def start(found: SubmissionFolder) -> 'Future[GradedSubmission]':
            if found.problem:
                raise CourseError(found.problem)
            assignment = assignments[found.assignment]
            submission = read_submission(
                found.folder,
                student_id=found.student_id,
                assignment=found.assignment,
                packages=assignment.packages,
            )
            its_seed = assignment.seed_of(submission.student_id)
            key = key_of(submission, assignment.conditions, seed=its_seed)
            if not force and (earlier := find_earlier_result(course, submission, key)):
                return completed(GradedSubmission(submission, earlier))
            judged = submit_for_grading(  # restores it here; runs and judges it in a worker
                submission,
                assignment.template,
                backend=backend,
                seed=its_seed,
                trust_students=trust_students,
            )
            return then(judged, lambda result: _graded(submission, result, key))

        with one_engine(course.db_url):
            for found, work in run_ahead(submissions, start, at_most=AHEAD * backend.capacity):
                yield _store(course, found, work)


def _prepare(
    course: Course, submissions: Sequence[SubmissionFolder], *, seed: str, isolated: bool
) -> dict[str, _PreparedAssignment]:
    """Bring the gradebook in order, and return what each assignment is graded by."""
    deadlines(course.gradebook, course.assignments())  # what is wrong with them is said now
    prepared = {}
    with in_sentences(course), gradebook_lock(course.gradebook):
        bring_in_order(course)
        for name in sorted({each.assignment for each in submissions if not each.problem}):
            register(course, name)
            prepared[name] = _PreparedAssignment(
                template=prepared_template(course, name),
                seed_of=(lambda _: seed) if seed else course.seeds(name),
                packages=course.packages(name),
                conditions=conditions(course, name, isolated=isolated),
            )
    return prepared


def _graded(submission: Submission, result: Result, key: str) -> GradedSubmission:
    remember(result.notebook, key)
    return GradedSubmission(submission, result.notebook, seconds=result.seconds)


def _store(
    course: Course, found: SubmissionFolder, work: 'Future[GradedSubmission]'
) -> SubmissionOutcome:
    """Wait until a submission is judged, and store it; say why where that can't be done."""
    stored, reason, seconds, reused = None, found.problem, None, False
    which = printable(f'{found.assignment} of {found.student_id}')
    try:
        graded = work.result()
        seconds = graded.seconds
        with in_sentences(course), gradebook_lock(course.gradebook):
            if seconds is None:
                stored = refresh_late_penalty(course, graded.submission, graded.notebook)
                reused = stored is not None
            stored = stored or store(course, graded.submission, graded.notebook)
        reason = stored.reason
    except (GradebookError, ClusterError):
        raise  # nothing comes of the next one either
    except TaskFailed as error:
        logging.error('%s: %s\n%s', which, error, error.trace)
        reason = f'not graded, the grader failed: {error}'
    except Exception as error:  # the next submission can do nothing for it
        if not found.problem:
            logging.exception('%s', which)
            reason = f'not graded, the grader failed: {type(error).__name__}: {error}'
    return SubmissionOutcome(found.student_id, found.assignment, stored, reason, seconds, reused)
