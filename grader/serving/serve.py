"""The resident process: take in, grade, store and release, again and again, until it is ended."""

import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from grader.common.errors import CourseError
from grader.course import Course
from grader.grading import Grading
from grader.serving.intake import remove_unrecorded_copies
from grader.serving.queue import Queue
from grader.serving.queue_file import open_queue
from grader.serving.reception import take_in_new_entries
from grader.serving.removed_entries import RemovedEntries
from grader.serving.results import grade_undecided, store_finished
from grader.serving.state import ServingState, check_for_pause
from grader.serving.steps import start_gradings, store_replaced
from grader.storage.backups import recover_and_back_up
from grader.storage.database import share_engine
from grader.storage.deadlines import deadlines
from grader.workers.backend import Backend

LOOK_SEC = 0.25
"""Interval at which the inbound folder is checked."""
LOCK = '.serve.lock'


def serve(
    course: Course,
    inbound: Path,
    *,
    backend: Backend,
    feedback: Path | None = None,
    trust_students: bool = False,
    once: bool = False,
    say: Callable[[str], None] = print,
    changed: Callable[[Queue], object] = lambda queue: None,
) -> None:
    """Grade what arrives in `inbound`, and release its feedback, until KeyboardInterrupt.

    With `once`, until there is nothing left to do. `say` gets a line for each event, `changed` the
    queue after each change. Raises CourseError if another process serves this gradebook, and
    GradebookError if it can't be written to; the next run finishes what was begun.
    """
    with (
        serving_lock(course),
        backend,
        open_queue(course.gradebook, inbound) as queue,
        share_engine(course.db_url),
    ):
        isolated = backend.require_isolation(trust_students=trust_students)
        recover_and_back_up(course)
        queue.resume()
        remove_unrecorded_copies(course, queue)
        grading = Grading(course, backend, isolated, trust_students=trust_students)
        serving = ServingState(course, queue, grading, inbound, feedback, say, seen=queue.seen())
        removed = RemovedEntries(serving)
        deadlines(course.gradebook)  # raises now if it can't be read
        while True:
            events = [take_in_new_entries(serving), not once and check_for_pause(serving)]
            if not serving.pause:
                steps = start_gradings, store_finished, store_replaced
                events += [step(serving) for step in steps]
            if any([*events, removed.forget()]):
                changed(queue)
            elif serving.rounds.is_under_way:
                continue
            elif serving.pause:
                time.sleep(LOOK_SEC)
            elif serving.running:
                wait(serving.running, timeout=LOOK_SEC, return_when=FIRST_COMPLETED)
            elif grade_undecided(serving):
                continue
            elif once:
                return
            else:
                time.sleep(LOOK_SEC)


@contextmanager
def serving_lock(course: Course) -> Iterator[None]:
    """Hold the lock for serving a gradebook. Raises CourseError if another process has it."""
    course.gradebook.mkdir(parents=True, exist_ok=True)
    lock = FileLock(course.gradebook / LOCK, fallback_to_soft=False)
    try:
        lock.acquire(timeout=0)
    except Timeout:
        raise CourseError(
            f'another process serves {course.gradebook} already: ./course serve --status'
        ) from None
    try:
        yield
    finally:
        lock.release()
