"""What waits to be graded: what is handed back has earlier results of it, or none."""

import os
from pathlib import Path

from grader.common.errors import CourseError
from grader.course import Course
from grader.notebook.submission import unread_submission
from grader.storage.reuse import are_of_another_lesson, is_of_other_files
from grader.storage.submitted import SubmissionFolder, find_submissions, is_new


def ungraded(course: Course) -> list[SubmissionFolder]:
    """Return the submissions that are new, or have changed since they were graded."""
    try:
        found = find_submissions(course)
    except CourseError:  # there is none
        return []
    return [
        each
        for each in found
        if not each.problem and (is_new(course, each) or _has_changed(course, each))
    ]


def changed_lessons(course: Course) -> list[str]:
    """Return the lessons that have changed since one of their submissions was graded."""
    return [name for name in course.assignments() if _has_changed_since(course, name)]


def _has_changed_since(course: Course, assignment: str) -> bool:
    """Whether a result is of another version; it is read only if the lesson's files are newer."""
    lesson = course.source_path(assignment), course.release_path(assignment)
    if not all(path.exists() for path in lesson):
        return False
    when = max(path.stat().st_mtime_ns for path in lesson)
    graded = course.folder('autograded', '', '').glob(f'*/{assignment}/{assignment}.ipynb')
    older = [path for path in graded if path.stat().st_mtime_ns < when]
    return bool(older) and are_of_another_lesson(course, assignment, older)


def _has_changed(course: Course, found: SubmissionFolder) -> bool:
    """Whether its files are others; they are read only if one of them is newer than the result.

    A newer one may be a copy. A result of nbgrader's own commands does not say of which files it
    is: ./course grade grades these again.
    """
    graded = course.folder('autograded', found.student_id, found.assignment)
    when = (graded / f'{found.assignment}.ipynb').stat().st_mtime_ns
    if all(time <= when for time in _times_in(found.folder)):
        return False
    submission = unread_submission(
        found.folder,
        student_id=found.student_id,
        assignment=found.assignment,
        packages=course.packages(found.assignment),
    )
    return is_of_other_files(course, submission)


def _times_in(folder: Path) -> list[int]:
    inside = [Path(above, name) for above, _, names in os.walk(folder) for name in names]
    return [path.lstat().st_mtime_ns for path in inside]
