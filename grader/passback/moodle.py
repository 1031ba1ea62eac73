"""Moodle: the grading worksheet of an assignment, and the archive of feedback files.

*Download grading worksheet* writes a worksheet, and *Upload grading worksheet* reads one. It
identifies a student by the participant number that is in each name of *Download all submissions*.
Its headings are in the site's language: these are the English ones.
"""

from collections.abc import Mapping
from pathlib import Path

from grader.collect.platform_ids import StudentNumbers
from grader.common.errors import CourseError
from grader.common.text import spreadsheet_table
from grader.course import Course
from grader.passback.final_scores import AssignmentScores, FinalScore
from grader.passback.import_files import ImportFile
from grader.passback.numbered import table_by_number
from grader.passback.roster import Roster, match, read_roster

IDENTIFIER, FULL_NAME, GRADE = 'Identifier', 'Full name', 'Grade'
MODIFIED, MAXIMUM = 'Last modified (grade)', 'maximum grade'
"""The heading of the maximum in lower case: some versions of Moodle write Grade with a capital."""
NEEDED = (IDENTIFIER, FULL_NAME, GRADE, MODIFIED)
PARTICIPANT = 'Participant '
NEVER = '-'
"""Moodle's text for a grade that was never given: a newer grade in Moodle is then kept."""
HOW = (
    "Take the assignment's grading worksheet: in Moodle, in English, turn on Offline grading "
    'worksheet in its settings, and choose Download grading worksheet'
)


def make_worksheet(
    course: Course, scores: AssignmentScores, roster_path: Path | None = None
) -> ImportFile:
    """Return a grading worksheet to upload; if Moodle's own is given, its columns are kept.

    Raises CourseError if that can't be read, or has another maximum.
    """
    if roster_path is None:
        return table_by_number(
            course,
            scores,
            'Moodle',
            download='Download all submissions',
            headings=NEEDED,
            row_of=lambda each, number: [
                f'{PARTICIPANT}{number}',
                each.student_id,
                each.score,
                NEVER,
            ],
        )
    roster = read_roster(roster_path, NEEDED, HOW)
    numbers = StudentNumbers(course)

    found = match(
        [each.student_id for each in scores.final],
        roster,
        number_of=lambda student: numbers.of(student, scores.assignment).get('moodle'),
        number_in=lambda row: row[IDENTIFIER].removeprefix(PARTICIPANT),
        name_of=lambda row: row[FULL_NAME],
    )
    rows: list[list[object]] = [list(roster.headings)]
    notes = set()
    for each in scores.final:
        if row := found.rows.get(each.student_id):
            notes.add(_check_maximum(row, each, scores.assignment, roster))
            filled = {**row, GRADE: each.score}
            rows.append([filled.get(heading, '') for heading in roster.headings])
    return ImportFile(
        spreadsheet_table(rows), len(rows) - 1, found.unclear, tuple(filter(None, notes))
    )


def _check_maximum(
    row: Mapping[str, str], score: FinalScore, assignment: str, roster: Roster
) -> str:
    """Check that the assignment has the same maximum in Moodle; return a note if nothing shows it.

    Raises CourseError if it has another one.
    """
    expected = f'{score.max_score:g}'
    said = [row[heading] for heading in roster.headings if heading.casefold() == MAXIMUM]
    try:
        most = float(said[0].replace(',', '.'))
    except (IndexError, ValueError):  # for example with a scale instead of points
        return (
            f"{roster.path.name} has no number in a column 'Maximum Grade', so nothing shows how "
            f'many points this assignment gives in Moodle: check that its maximum grade is '
            f'{expected} there before you upload the file'
        )
    if most != score.max_score:
        raise CourseError(
            f'{roster.path}: the most that this assignment gives in Moodle is {most:g}, and '
            f'{assignment} gives {expected}: set its maximum grade to {expected} in Moodle, and '
            'download the worksheet again'
        )
    return ''


def name_feedback_file(student_id: str, number: str, assignment: str) -> str:
    """Return a name by which *Upload multiple feedback files in a zip* identifies the student.

    Moodle splits the name at underscores, so those of the student's name become spaces.
    """
    return f'{student_id.replace("_", " ")}_{number}_assignsubmission_file_{assignment}.html'
