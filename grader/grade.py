"""The whole flow: read a submission, heal it, run it in its rooms, store what came of it."""

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from grader.course import Course
from grader.errors import CourseError
from grader.execute import execute
from grader.gradebook import Stored, register, store
from grader.heal import heal
from grader.pipeline import prepare, unanswered
from grader.submission import read_submission
from grader.turn import Turn


@dataclass(frozen=True)
class HandedIn:
    """Something under gradebook/submitted/."""

    student_id: str
    assignment: str
    folder: Path
    problem: str = ''
    """Why it can't be a submission of anything."""


@dataclass(frozen=True)
class Row:
    """What the run says of one submission."""

    student_id: str
    assignment: str
    stored: Stored | None
    """What the gradebook holds now; None where nothing could be stored."""
    reason: str


def grade_submission(course: Course, found: HandedIn, *, seed: str = '') -> Stored:
    """Grade one submission and store its scores; the same again when done again.

    `seed` replays inputs that hidden tests choose; by default they are the assignment's own.
    """
    student_id, assignment = found.student_id, found.assignment
    submission = read_submission(found.folder, student_id=student_id, assignment=assignment)
    if submission.problem:
        graded = unanswered(course, submission, submission.problem)
    else:
        healed = heal(submission.notebook, course.master(assignment))
        graded = execute(
            prepare(course, assignment, healed.notebook),
            extra_files=submission.extra_files,
            seed=seed or course.seed(assignment),
        ).notebook
    with Turn.take(course.gradebook):
        return store(course, submission, graded)


def grade_all(course: Course, submissions: list[HandedIn], *, seed: str = '') -> Iterator[Row]:
    """Grade submissions one after the other; each gets its row, whatever becomes of it."""
    with Turn.take(course.gradebook):
        for assignment in sorted({found.assignment for found in submissions if not found.problem}):
            register(course, assignment)
            course.master(assignment)  # says now what would be wrong with each submission
    for found in submissions:
        stored, reason = None, found.problem
        if not found.problem:
            try:
                stored = grade_submission(course, found, seed=seed)
                reason = stored.reason
            except Exception as error:  # the next submission can do nothing for it
                logging.exception('%s of %s', found.assignment, found.student_id)
                reason = f'not graded, the grader failed: {type(error).__name__}: {error}'
        yield Row(found.student_id, found.assignment, stored, reason)


def find_submissions(
    course: Course, *, assignment: str | None = None, student_id: str | None = None
) -> list[HandedIn]:
    """Return what lies under gradebook/submitted/, sorted; what is out of place has a problem.

    Raises CourseError when nothing fits the assignment and the student asked for.
    """
    known = course.assignments()
    if assignment and assignment not in known:
        raise CourseError(f'there is no assignment {assignment!r}; there are: {", ".join(known)}')
    submitted = course.folder('submitted', '', '')
    found = [
        each
        for student in _visible(submitted)
        for each in _of_student(student, known)
        if assignment in (None, each.assignment) and student_id in (None, each.student_id)
    ]
    if not found:
        wanted = f' of {assignment}' if assignment else ''
        wanted += f' by {student_id}' if student_id else ''
        raise CourseError(
            f'there is no submission{wanted} in {submitted}: put each notebook at '
            f'{submitted}/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb'
        )
    return found


def _of_student(student: Path, known: list[str]) -> Iterator[HandedIn]:
    where = f'expected {student.parent.name}/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb'
    name = student.name
    if not student.is_dir():
        yield HandedIn(name, '', student, f"a file where a student's folder was expected: {where}")
        return
    for folder in _visible(student):
        problem = ''
        if not _is_text(name):
            problem = "the folder's name is not UTF-8: rename it to the student's id"
        elif not folder.is_dir():
            problem = f"a file where an assignment's folder was expected: {where}"
        elif folder.name not in known:
            problem = f'there is no such assignment: {where}, one of {", ".join(known)}'
        yield HandedIn(name, folder.name, folder, problem)


def _visible(folder: Path) -> list[Path]:
    """Return what lies in a folder, sorted; what editors and desktops hide there left out."""
    if not folder.is_dir():
        return []
    return sorted(path for path in folder.iterdir() if not path.name.startswith('.'))


def _is_text(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True
