"""Write files that course platforms import, one for each assignment, to gradebook/PLATFORM/."""

import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

from grader.collect.platform_ids import StudentNumbers
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course
from grader.passback import canvas, moodle
from grader.passback.final_scores import final_scores
from grader.storage.records import records

TABLES = {'moodle': moodle.make_worksheet, 'canvas': canvas.make_table}
"""Platforms that import scores, with the function that makes the table."""


def write_platform_scores(
    course: Course,
    platform: str,
    assignment: str,
    roster: Path | None,
    say: Callable[[str], None],
) -> list[Path]:
    """Write the final scores of an assignment, or of all; return the paths.

    An assignment without a row gets no file. `say` gets a line for each student without a row,
    with the reason, and for what a person should know before the import. Raises CourseError if
    the roster does not fit, or if nothing is graded.
    """
    found = final_scores(records(course), assignment)
    if assignment and not found:
        course.expect_assignment(assignment)
        raise CourseError(
            f'nothing of {assignment} is graded yet: first ./course collect, then ./course grade'
        )
    if platform == 'moodle' and roster and not assignment:
        raise CourseError(
            'a grading worksheet of Moodle is of one assignment: '
            './course scores ASSIGNMENT --format moodle --roster FILE'
        )
    paths = []
    for scores in found:
        made = TABLES[platform](course, scores, roster)
        if made.rows:
            path = _folder(course, platform) / f'{scores.assignment}.csv'
            write_whole(path, made.text)
            paths.append(path)
        for student in scores.waiting:
            say(f'{scores.assignment}: {student} needs manual grading in the formgrader')
        for line in (*made.notes, *made.left_out):
            say(f'{scores.assignment}: {line}')
    return paths


def write_feedback_archives(course: Course, say: Callable[[str], None]) -> list[Path]:
    """Pack the feedback pages for Moodle, an archive for each assignment; return the paths.

    `say` gets a line for each page that is left out.
    """
    numbers = StudentNumbers(course)
    pages: dict[str, dict[str, Path]] = {}
    for page in sorted(course.folder('feedback', '', '').glob('*/*/*.html')):
        student, assignment = page.parts[-3:-1]
        number = numbers.of(student, assignment).get('moodle')
        if number is None:
            say(
                f'{assignment}: {student} has no Moodle number, so no archive has that page: only '
                'work collected from *Download all submissions* has one.'
            )
        elif page.stem == assignment:
            name = moodle.name_feedback_file(student, number, assignment)
            pages.setdefault(assignment, {})[name] = page
    paths = []
    for assignment, named in pages.items():
        packed = BytesIO()
        with zipfile.ZipFile(packed, 'w', zipfile.ZIP_DEFLATED) as archive:
            for name, page in named.items():
                archive.write(page, name)
        path = _folder(course, 'moodle') / f'{assignment}-feedback.zip'
        write_whole(path, packed.getvalue())
        paths.append(path)
    return paths


def _folder(course: Course, platform: str) -> Path:
    folder = course.gradebook / platform
    folder.mkdir(parents=True, exist_ok=True)
    return folder
