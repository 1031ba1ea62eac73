"""The submissions under gradebook/submitted/."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from grader.common.errors import CourseError
from grader.common.student_names import HTML, problem_of_id
from grader.course import Course


@dataclass(frozen=True)
class SubmissionFolder:
    """An entry under gradebook/submitted/."""

    student_id: str
    assignment: str
    folder: Path
    problem: str = ''
    """Why it can't be graded as a submission."""


def known_students(course: Course) -> list[str]:
    """Return the students who have handed in something."""
    return [folder.name for folder in _visible(course.folder('submitted', '', ''))]


def find_submissions(
    course: Course, *, assignment: str | None = None, student_id: str | None = None
) -> list[SubmissionFolder]:
    """Return what is under gradebook/submitted/, sorted; a misplaced file has a problem.

    Raises CourseError if nothing is there for the given assignment and student.
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
    """Whether a submission has no earlier result that could be used again."""
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
    """Return the content of a folder, sorted, without hidden files of editors and desktops."""
    if not folder.is_dir():
        return []
    return sorted(path for path in folder.iterdir() if not path.name.startswith('.'))


def _is_text(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True
