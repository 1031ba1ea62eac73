"""Make a platform's table without a roster, with the numbers that came with the submissions."""

from collections.abc import Callable, Sequence

from grader.collect.platform_ids import StudentNumbers
from grader.common.text import spreadsheet_table
from grader.course import Course
from grader.passback.final_scores import AssignmentScores, FinalScore
from grader.passback.import_files import ImportFile


def table_by_number(
    course: Course,
    scores: AssignmentScores,
    platform: str,
    *,
    download: str,
    headings: Sequence[str],
    row_of: Callable[[FinalScore, str], list[object]],
) -> ImportFile:
    """Return a table of the students whose number on a platform, such as 'Moodle', is known.

    `download` is the platform's name for the archive that has the numbers in its file names;
    `row_of` makes the row of a student from the score and the number.
    """
    numbers = StudentNumbers(course)
    rows: list[list[object]] = [list(headings)]
    unclear = []
    for each in scores.final:
        number = numbers.of(each.student_id, scores.assignment).get(platform.lower())
        if number is None:
            unclear.append(
                f'{each.student_id} has no {platform} number: only work collected from '
                f'*{download}* has one. Enter this score by hand, or use --roster FILE.'
            )
        else:
            rows.append(row_of(each, number))
    return ImportFile(spreadsheet_table(rows), len(rows) - 1, tuple(unclear))
