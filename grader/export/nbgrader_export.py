"""Replace the table of `nbgrader export`: the same columns, with current late penalties."""

from datetime import datetime
from pathlib import Path

from nbgrader.api import Assignment, Gradebook, MissingEntry, Student
from nbgrader.plugins import ExportPlugin

from grader.common.db_url import gradebook_of
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.common.points import sum_points
from grader.common.text import BYTE_ORDER_MARK, spreadsheet_table
from grader.course import Course
from grader.storage.lateness import recount_late_penalties
from grader.storage.registering import withdrawn_unseen

COLUMNS = (
    'assignment',
    'duedate',
    'timestamp',
    'student_id',
    'last_name',
    'first_name',
    'email',
    'raw_score',
    'late_submission_penalty',
    'score',
    'max_score',
)


class CsvExport(ExportPlugin):
    """nbgrader's table, used instead of its CsvExportPlugin.

    That plugin writes late penalties as of the last grading, and no quotes: a comma in a name
    moves all that follows into the next column. It also lists a lesson that was withdrawn before
    anybody handed it in, with a zero for each student.
    """

    def export(self, gradebook: Gradebook) -> None:
        """Write the table into the file of `--to`, or grades.csv."""
        try:
            course = self._course()
            if course is not None:
                recount_late_penalties(course)
        except CourseError as problem:
            raise SystemExit(f'course: {problem}') from None
        path = Path(self.to or 'grades.csv')
        assignments = {str(each) for each in self.assignment}
        students = {str(each) for each in self.student}
        left_out = withdrawn_unseen(course, gradebook) - assignments if course else set()
        rows = [
            _row(gradebook, assignment, student)
            for assignment in sorted(gradebook.assignments, key=_when_due)
            if not assignments or assignment.name in assignments
            if assignment.name not in left_out
            for student in sorted(gradebook.students, key=_named)
            if not students or student.id in students
        ]
        # for programs, which know the first column by its name: so without a byte-order mark
        table = spreadsheet_table([COLUMNS, *rows]).removeprefix(BYTE_ORDER_MARK)
        try:
            if path.is_symlink() or (path.exists() and not path.is_file()):
                # for example /dev/stdout, which must not be replaced by a file
                path.write_text(table, encoding='utf-8', newline='')
            else:
                write_whole(path, table)
        except OSError as error:
            raise SystemExit(
                f'course: {path} cannot be written: {error.strerror}; name another file with --to'
            ) from None
        self.log.info('%s: %d rows', path, len(rows))

    def _course(self) -> Course | None:
        """Return the course whose gradebook this is; None for a backup, exported as it is."""
        directories = self.parent.coursedir
        root = Path(directories.root)
        course = Course(root, gradebook_of(directories.db_url, root))
        is_its = directories.db_url.split('?')[0] == course.db_url.split('?')[0]
        return course if is_its else None


def _when_due(assignment: Assignment) -> tuple[bool, datetime, str]:
    """Return a sort key: nbgrader's order in SQLite, where assignments without a date come first.

    PostgreSQL puts them last, compares names by its locale, and does not keep the order of equals.
    """
    due = assignment.duedate
    return due is not None, due or datetime.min, assignment.name


def _named(student: Student) -> tuple[str, str, str]:
    return student.last_name or '', student.first_name or '', student.id


def _row(gradebook: Gradebook, assignment: Assignment, student: Student) -> list[object]:
    """Return one student's row for one assignment: zeros if nothing was handed in."""
    timestamp, score, penalty = None, 0.0, 0.0
    try:
        submission = gradebook.find_submission(assignment.name, student.id)
    except MissingEntry:
        pass
    else:
        timestamp, score = submission.timestamp, submission.score
        penalty = submission.late_submission_penalty
    values = [
        assignment.name,
        assignment.duedate,
        timestamp,
        student.id,
        student.last_name,
        student.first_name,
        student.email,
        score,
        penalty,
        max(0.0, sum_points([score, -penalty])),
        assignment.max_score,
    ]
    return ['' if value is None else value for value in values]
