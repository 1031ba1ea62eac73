"""Writes nbgrader's database, and nothing else does: lessons, scores, executed notebooks."""

import json
import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import nbformat
from nbformat import NotebookNode
from nbgrader.api import Grade, Gradebook

from grader.common.errors import GradebookError
from grader.common.files import write_whole
from grader.common.text import printable
from grader.course import Course
from grader.notebook.restore import KEY
from grader.notebook.submission import Submission, read_submission, submission_time
from grader.storage.database import (
    make_database,
    open_database,
    raise_gradebook_errors,
    wait_until_free,
)
from grader.storage.held_scores import HeldScore, held_score, manual_scores
from grader.storage.kept_files import keep_files
from grader.storage.lateness import recount_late_penalties
from grader.storage.lock import gradebook_lock
from grader.storage.pipeline import (
    first_reason,
    has_broken_checks,
    is_undecided,
    resources_of,
    store_scores,
)
from grader.storage.registering import register, register_all
from grader.storage.rewritten_answers import note_rewritten

_JOURNAL = '.{}.ipynb.begun'
"""A journal: the executed notebook, kept in its folder until all of it is stored."""


@dataclass(frozen=True)
class StoredResult:
    """What the gradebook holds for a submission after it was graded."""

    score: float
    max_score: float
    former: float | None
    """The score before this grading, if there was one."""
    pending: bool
    """Whether a part of the score waits for manual grading."""
    reason: str
    """Why points are missing: the first reason, or ''."""
    late: float = 0.0
    """The points that lateness takes off the score."""
    undecided: bool = False
    """Whether a check could not decide, and nobody has given its points: it is graded again."""
    broken: bool = False
    """Whether the test kernel crashed or hung at one of these checks."""


def register_before_autograde(*, assignment: str, **_: object) -> None:
    """Register what `nbgrader autograde`, which runs in the course's folder, is going to grade."""
    course = Course.at(Path.cwd())
    recover(course)
    for name in course.assignments() if assignment == '*' else [assignment]:
        register(course, name)


def store(course: Course, submission: Submission, graded: NotebookNode) -> StoredResult:
    """Store an executed notebook: its scores, and the notebook itself under autograded/.

    The same nbgrader preprocessors do it as in `nbgrader autograde`. Manual scores stay, unless
    the answer was rewritten since; the submitted files are only read, and storing twice is the
    same as once. If the process is killed, `recover` finishes it. Raises GradebookError, and
    changes nothing, if the disk is full or the database is not available.
    """
    journal = _journal(course, submission)
    whose = submission.student_id, submission.assignment
    try:
        with raise_gradebook_errors(course):
            wait_until_free(course)
            with open_database(course.db_url) as book:  # one connection for all that follows
                former = held_score(book, *whose)
                by_hand = manual_scores(book, *whose) if former else {}
                if by_hand or (former and former.pending):
                    note_rewritten(graded, journal.with_name(f'{whose[1]}.ipynb'), by_hand)
                keep_files(course, submission)
                # with ensure_ascii=False, text that can't be encoded fails here, not half-way
                write_whole(journal, json.dumps(graded, ensure_ascii=False))
                saved = _store_all(course, submission, graded)
                now = held_score(book, *whose)
    except (GradebookError, OSError):
        raise  # the user can fix that, and then `recover` finishes
    except Exception:
        journal.unlink(missing_ok=True)
        raise
    assert now is not None  # it was stored
    return StoredResult(
        score=now.score,
        max_score=now.max_score,
        former=former.score if former else None,
        pending=now.pending,
        reason=first_reason(saved),
        late=now.late,
        undecided=now.pending and is_undecided(graded),
        broken=now.pending and has_broken_checks(graded),
    )


def recover(course: Course) -> None:
    """Finish storing what a killed run had begun to store, and print it: no run reports it."""
    found = sorted(course.folder('autograded', '', '').glob(f'*/*/{_JOURNAL.format("*")}'))
    if not found:
        return
    with gradebook_lock(course.gradebook):
        make_database(course)
        for journal in filter(Path.exists, found):
            student, assignment = journal.parts[-3:-1]
            folder = course.folder('submitted', student, assignment)
            try:
                submission = read_submission(
                    folder,
                    student_id=student,
                    assignment=assignment,
                    packages=course.packages(assignment),
                )
                with raise_gradebook_errors(course):
                    wait_until_free(course)
                    with open_database(course.db_url) as book:
                        former = held_score(book, student, assignment)
                        _store_all(course, submission, nbformat.read(journal, as_version=4))
                        now = held_score(book, student, assignment)
                print(_finished(student, assignment, former, now), file=sys.stderr, flush=True)
            except GradebookError:
                raise
            except Exception:  # for example because the lesson has changed: it is graded again
                logging.exception('%s of %s is not stored', assignment, printable(student))
                journal.unlink()


def _finished(
    student: str, assignment: str, former: HeldScore | None, now: HeldScore | None
) -> str:
    """Return what is said of a result that a killed run had begun to store."""
    assert now is not None  # it was stored
    score = f'{now.score:g}' if former is None else f'{former.score:g} → {now.score:g}'
    return (
        f'{printable(student)}  {assignment}  {score} of {now.max_score:g}: an earlier run ended '
        'while it stored this result; it is complete now'
    )


def _store_all(course: Course, submission: Submission, graded: NotebookNode) -> NotebookNode:
    """Store what is in the journal; doing it again is the same as doing it once."""
    student, assignment = submission.student_id, submission.assignment
    at = resources_of(course, assignment, student)
    at['nbgrader']['timestamp'], notes = submission_time(submission)
    graded = nbformat.from_dict(graded)
    graded.metadata.setdefault(KEY, nbformat.from_dict({'notes': []})).notes += notes
    folder = course.folder('autograded', student, assignment)
    saved = store_scores(graded, at)
    write_whole(folder / f'{assignment}.ipynb', nbformat.v4.writes(saved))
    _journal(course, submission).unlink()
    return saved


def _journal(course: Course, submission: Submission) -> Path:
    folder = course.folder('autograded', submission.student_id, submission.assignment)
    return folder / _JOURNAL.format(submission.assignment)


@contextmanager
def open_gradebook(course: Course) -> Iterator[Gradebook]:
    """Open the database for reading, after every assignment of the course was registered."""
    recover(course)
    register_all(course)
    recount_late_penalties(course)
    with open_database(course.db_url) as book:
        yield book


def needs_manual_grade(grade: Grade) -> bool:
    """Whether the cell has neither an automatic nor a manual score."""
    return grade.auto_score is None and grade.manual_score is None
