"""The whole flow: read a submission, heal it, run it in its rooms, store what came of it."""

import logging
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

from nbformat import NotebookNode

from grader.common.errors import ClusterError, CourseError, GradebookError, TaskFailed
from grader.common.text import printable
from grader.course import Course
from grader.judging.task import Result
from grader.notebook.restore import Master
from grader.notebook.submission import Submission, read_submission
from grader.storage.backups import bring_in_order
from grader.storage.database import in_sentences, one_engine
from grader.storage.gradebook import Stored, register, store
from grader.storage.late_penalties import deadlines
from grader.storage.lock import Turn
from grader.storage.pipeline import prepared_master
from grader.storage.reuse import conditions, held, kept, key_of, remember
from grader.storage.submitted import HandedIn
from grader.workers.backend import Crew, judged
from grader.workers.workers import Workers

AHEAD = 4
"""How many times more submissions may be done and wait for a slower one before them."""


@dataclass(frozen=True)
class Graded:
    """A submission that was judged, and is not stored yet."""

    submission: Submission
    notebook: NotebookNode
    """With a verdict in each grade cell."""
    seconds: float | None = None
    """How long that took where it ran; None where nothing was run, for it had been before."""


@dataclass(frozen=True)
class _Way:
    """How the submissions of one run are graded."""

    masters: dict[str, Master]
    """By assignment; so are the next two."""
    seeds: dict[str, Callable[[str], str]]
    """Gives each student's seed."""
    given: dict[str, str]
    """What else a result depends on, as a hash."""
    trust_students: bool
    force: bool
    """Whether to run what was run before, too."""


@dataclass(frozen=True)
class Row:
    """What the run says of one submission."""

    student_id: str
    assignment: str
    stored: Stored | None
    """What the gradebook holds now; None where nothing could be stored."""
    reason: str
    seconds: float | None = None
    """How long it was graded; None where nothing was run."""
    reused: bool = False
    """Whether nothing has changed since, so that the stored result holds."""


def grade_all(
    course: Course,
    submissions: Sequence[HandedIn],
    *,
    crew: Crew | None = None,
    seed: str = '',
    trust_students: bool = False,
    force: bool = False,
) -> Iterator[Row]:
    """Let a crew grade submissions, and store them in their order, one after the other.

    Each gets its row, whatever becomes of it. The crew is this machine's worker processes unless
    another is given. `seed` replays inputs that hidden tests choose; by default they are each
    student's own. Doing it again gives the same; where nothing has changed the stored result
    holds, unless told to `force` a new one. Raises CourseError, and runs nothing, where there is
    no sandbox, unless told to `trust_students`.
    """
    with crew or Workers() as crew:
        in_sandbox = crew.isolated(trust_students=trust_students)
        way = _Way({}, {}, {}, trust_students=trust_students, force=force)
        # what would be wrong with each submission is said now
        deadlines(course.gradebook, course.assignments())
        with in_sentences(course), Turn.take(course.gradebook):
            bring_in_order(course)
            for assignment in sorted(
                {each.assignment for each in submissions if not each.problem}
            ):
                register(course, assignment)
                way.masters[assignment] = prepared_master(course, assignment)
                way.seeds[assignment] = (lambda _: seed) if seed else course.seeds(assignment)
                way.given[assignment] = conditions(course, assignment, isolated=in_sandbox)
        with one_engine(course.db_url):
            under_way: deque[tuple[HandedIn, Future[Graded]]] = deque()
            for found in submissions:
                under_way.append((found, _begun(course, found, way, crew)))
                while under_way and (
                    len(under_way) >= AHEAD * crew.room or under_way[0][1].done()
                ):
                    yield _row(course, *under_way.popleft())
            while under_way:
                yield _row(course, *under_way.popleft())


def _begun(course: Course, found: HandedIn, way: _Way, crew: Crew) -> 'Future[Graded]':
    """Have one submission graded, or find what came of it before; nothing is stored yet."""
    graded: Future[Graded] = Future()
    try:
        if found.problem:
            raise CourseError(found.problem)
        assignment = found.assignment
        submission = read_submission(
            found.folder, student_id=found.student_id, assignment=assignment
        )
        its_seed = way.seeds[assignment](submission.student_id)
        key = key_of(submission, way.given[assignment], seed=its_seed)
        if not way.force and (before := kept(course, submission, key)):
            graded.set_result(Graded(submission, before))
            return graded
        work = judged(
            submission,
            way.masters[assignment],
            crew=crew,
            seed=its_seed,
            trust_students=way.trust_students,
        )
    except Exception as error:  # it is told in its turn
        graded.set_exception(error)
        return graded

    def settle(done: 'Future[Result]') -> None:
        try:
            result = done.result()
            remember(result.notebook, key)
            graded.set_result(Graded(submission, result.notebook, seconds=result.seconds))
        except BaseException as error:
            graded.set_exception(error)

    work.add_done_callback(settle)
    return graded


def _row(course: Course, found: HandedIn, work: Future[Graded]) -> Row:
    """Wait for a submission's turn to be stored, and store it."""
    stored, reason, seconds, reused = None, found.problem, None, False
    which = printable(f'{found.assignment} of {found.student_id}')
    try:
        graded = work.result()
        seconds = graded.seconds
        with in_sentences(course), Turn.take(course.gradebook):
            if seconds is None:
                stored = held(course, graded.submission, graded.notebook)
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
    return Row(found.student_id, found.assignment, stored, reason, seconds, reused)
