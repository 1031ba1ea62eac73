"""What lies under gradebook/submitted/, waiting to be graded."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from grader.common.errors import CourseError
from grader.common.student_names import HTML, problem_of_id
from grader.course import Course


@dataclass(frozen=True)
class SubmissionFolder:
    """Something under gradebook/submitted/."""

    student_id: str
    assignment: str
    folder: Path
    problem: str = ''
    """Why it can't be a submission of anything."""


def known_students(course: Course) -> list[str]:
    """Return the students of whom something was handed in."""
    return [folder.name for folder in _visible(course.folder('submitted', '', ''))]


def find_submissions(
    course: Course, *, assignment: str | None = None, student_id: str | None = None
) -> list[SubmissionFolder]:
    """Return what lies under gradebook/submitted/, sorted; what is out of place has a problem.

    Raises CourseError when nothing fits the assignment and the student asked for.
    """
    if assignment:
        course.expect_assignment(assignment)
    submitted, known = course.folder('submitted', '', ''), course.assignments()
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
            f'there is no submission{wanted} in {submitted}: expected '
            'STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb there, where ./course collect FOLDER puts what '
            'was handed in'
        )
    return found


def is_new(course: Course, found: SubmissionFolder) -> bool:
    """Whether a submission has no result that could still hold."""
    graded = course.folder('autograded', found.student_id, found.assignment)
    return not found.problem and not (graded / f'{found.assignment}.ipynb').exists()


def _of_student(student: Path, known: list[str]) -> Iterator[SubmissionFolder]:
    where = f'expected {student.parent.name}/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb'
    name = student.name
    if not student.is_dir():
        yield SubmissionFolder(
            name, '', student, f"a file where a student's folder was expected: {where}"
        )
        return
    for folder in _visible(student):
        problem = ''
        if not _is_text(name):
            problem = "the folder's name is not UTF-8: rename it to the student's id"
        elif HTML.intersection(name):
            problem = problem_of_id(name)
        elif not folder.is_dir():
            problem = f"a file where an assignment's folder was expected: {where}"
        elif folder.name not in known:
            problem = f'there is no such assignment: {where}, one of {", ".join(known)}'
        yield SubmissionFolder(name, folder.name, folder, problem)


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
