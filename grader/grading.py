"""One submission: read, restored, run and judged by a backend, and stored."""

import logging
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from functools import cache, partial

from nbformat import NotebookNode

from grader.collect.submission_folders import contents
from grader.common.errors import ClusterError, GradebookError, SubmissionChanged, TaskFailed
from grader.common.futures import completed_future, then
from grader.common.text import printable
from grader.course import Course
from grader.judging.task import Result
from grader.notebook.restore import AssignmentTemplate
from grader.notebook.submission import Submission, read_notebook_of, unread_submission
from grader.storage.failures import raise_gradebook_errors
from grader.storage.gradebook import StoredResult, store
from grader.storage.lock import gradebook_lock
from grader.storage.pipeline import sanitize_template
from grader.storage.registering import register
from grader.storage.reuse import (
    conditions_digest,
    files_digest,
    find_earlier_result,
    key_of,
    lesson_digest,
    refresh_late_penalty,
    write_key,
)
from grader.storage.seeds import seeds
from grader.storage.submitted import SubmissionFolder
from grader.workers.backend import Backend, submit_for_grading

CHANGED = 'its files have changed meanwhile: run ./course grade again'
GONE = 'its folder was removed meanwhile'


@dataclass(frozen=True)
class GradedSubmission:
    """A submission that was judged and is not stored yet."""

    submission: Submission
    """Its notebook was not read if an earlier result is used again."""
    notebook: NotebookNode
    """With a verdict in each grade cell."""
    files: Mapping[str, bytes]
    """Digests of the files that were judged, by name."""
    seconds: float | None = None
    """Seconds that grading took where it ran; None if an earlier result is used again."""


@dataclass(frozen=True)
class SubmissionOutcome:
    """What the run reports about one submission."""

    student_id: str
    assignment: str
    stored: StoredResult | None
    """What the gradebook holds now; None if nothing could be stored."""
    reason: str
    seconds: float | None = None
    """Seconds that grading took; None if nothing was run."""
    reused: bool = False
    """Whether nothing has changed since the last grading, so that its result is used again."""
    again: bool = False
    """Whether it follows an outcome of the same run in which a check could not decide."""

    @property
    def is_undecided(self) -> bool:
        """Whether a check could not decide."""
        return self.stored is not None and self.stored.undecided

    @property
    def may_be_decided(self) -> bool:
        """Whether a check could not decide, and may if nothing else keeps the machine busy."""
        return self.stored is not None and self.stored.undecided and not self.stored.broken


@dataclass(frozen=True)
class PreparedAssignment:
    """What the submissions of one assignment have in common."""

    template: Callable[[], AssignmentTemplate]
    """Returns what they are restored from; made when the first of them has to be run."""
    seed_of: Callable[[Submission], str]
    """Returns the seed of a submission."""
    packages: tuple[str, ...]
    """ROS packages that are handed in with the notebook."""
    lesson: str
    """A hash of the lesson."""
    conditions: str
    """A hash of everything else that a result depends on, with the lesson."""


@dataclass(frozen=True)
class Grading:
    """Grades submissions of prepared assignments, one by one, with a backend that has begun."""

    course: Course
    backend: Backend
    isolated: bool
    seed: str = ''
    """Replays inputs that hidden tests choose; by default each student has a seed of their own."""
    trust_students: bool = False
    force: bool = False

    def prepare(self, assignment: str) -> PreparedAssignment:
        """Register an assignment, and return what grading its submissions needs."""
        with raise_gradebook_errors(self.course), gradebook_lock(self.course.gradebook):
            register(self.course, assignment)
            template = self.course.template(assignment)
            lesson = lesson_digest(self.course, assignment)
            return PreparedAssignment(
                template=cache(partial(self._prepared, assignment, template)),
                seed_of=(lambda _: self.seed) if self.seed else seeds(self.course, assignment),
                packages=self.course.packages(assignment),
                lesson=lesson,
                conditions=conditions_digest(lesson, isolated=self.isolated),
            )

    def _prepared(self, assignment: str, template: AssignmentTemplate) -> AssignmentTemplate:
        with raise_gradebook_errors(self.course), gradebook_lock(self.course.gradebook):
            return sanitize_template(self.course, assignment, template)

    def start(
        self, found: SubmissionFolder, prepared: PreparedAssignment
    ) -> Future[GradedSubmission]:
        """Read and restore a submission; have it run and judged unless a result can be reused."""
        files = contents(found.folder)
        submission = unread_submission(
            found.folder,
            student_id=found.student_id,
            assignment=found.assignment,
            packages=prepared.packages,
        )
        its_seed = prepared.seed_of(submission)
        key = key_of(submission, prepared.conditions, seed=its_seed)
        earlier = self._earlier(submission, key)
        if earlier is None:  # else the same bytes were read then, and need not be read again
            submission = read_notebook_of(submission)
            if submission.problem:
                key = key_of(submission, prepared.conditions, seed=its_seed)
                earlier = self._earlier(submission, key)
        if earlier:
            return completed_future(GradedSubmission(submission, earlier, files))
        if not submission.problem:
            self.backend.begin()  # workers start while the first template is prepared
        judged = submit_for_grading(  # restores it here; runs and judges it in a worker
            submission,
            prepared.template(),
            backend=self.backend,
            seed=its_seed,
            trust_students=self.trust_students,
        )
        digest = files_digest(submission)

        def graded(result: Result) -> GradedSubmission:
            write_key(result.notebook, key, digest, prepared.lesson)
            return GradedSubmission(submission, result.notebook, files, seconds=result.seconds)

        return then(judged, graded)

    def _earlier(self, submission: Submission, key: str) -> NotebookNode | None:
        return None if self.force else find_earlier_result(self.course, submission, key)

    def store(self, found: SubmissionFolder, work: Future[GradedSubmission]) -> SubmissionOutcome:
        """Wait until a submission is judged, and store it, or return why that can't be done."""
        stored, reason, seconds, reused = None, found.problem, None, False
        which = printable(f'{found.assignment} of {found.student_id}')
        try:
            graded = work.result()
            seconds = graded.seconds
            with raise_gradebook_errors(self.course), gradebook_lock(self.course.gradebook):
                if not found.folder.is_dir():
                    raise SubmissionChanged(GONE)
                if graded.files != contents(found.folder):
                    raise SubmissionChanged(CHANGED)
                if seconds is None:
                    stored = refresh_late_penalty(self.course, graded.submission, graded.notebook)
                    reused = stored is not None
                stored = stored or store(self.course, graded.submission, graded.notebook)
            reason = stored.reason
        except (GradebookError, ClusterError):
            raise  # the next submission would fail in the same way
        except SubmissionChanged as change:
            reason = f'not graded, {change}'
        except TaskFailed as error:
            logging.error('%s: %s\n%s', which, error, error.trace)
            reason = f'not graded, the grader failed: {error}'
        except Exception as error:  # it must not stop the submissions that follow
            if not found.problem:
                logging.exception('%s', which)
                reason = f'not graded, the grader failed: {type(error).__name__}: {error}'
        return SubmissionOutcome(
            found.student_id, found.assignment, stored, reason, seconds, reused
        )
