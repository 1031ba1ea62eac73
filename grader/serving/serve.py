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
from grader.serving.desk import Desk, begin_turns, finish_done, keep_replaced
from grader.serving.gone import Gone
from grader.serving.intake import tidy
from grader.serving.queue import Queue
from grader.serving.queue_file import opened_queue
from grader.serving.reception import look
from grader.storage.backups import bring_in_order
from grader.storage.database import one_engine
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
        only_one(course),
        backend,
        opened_queue(course.gradebook, inbound) as queue,
        one_engine(course.db_url),
    ):
        isolated = backend.require_isolation(trust_students=trust_students)
        bring_in_order(course)
        queue.resume()
        tidy(course, queue)
        grading = Grading(course, backend, isolated, trust_students=trust_students)
        desk = Desk(course, queue, grading, inbound, feedback, say, seen=queue.seen())
        gone = Gone(desk)
        while True:
            events = [look(desk), begin_turns(desk), finish_done(desk), keep_replaced(desk)]
            if any([*events, gone.forget()]):
                changed(queue)
            elif desk.rounds.is_under_way:
                continue
            elif once and not desk.running:
                return
            elif desk.running:
                wait(desk.running, timeout=LOOK_SEC, return_when=FIRST_COMPLETED)
            else:
                time.sleep(LOOK_SEC)


@contextmanager
def only_one(course: Course) -> Iterator[None]:
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
