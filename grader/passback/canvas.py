"""Canvas: the table that its gradebook imports.

It begins with the columns that identify a student, as in an export, up to Section. A column for
each assignment follows, with title and number in its heading. An empty field would delete a score
in Canvas, so each file is for one assignment and has only rows with a score. The row Points
Possible is left out: it would change how many points an assignment gives.
"""

import re
from pathlib import Path

from grader.collect.platform_ids import StudentNumbers
from grader.common.errors import CourseError
from grader.common.text import spreadsheet_table
from grader.course import Course
from grader.passback.final_scores import AssignmentScores
from grader.passback.import_files import ImportFile
from grader.passback.numbered import table_by_number
from grader.passback.roster import Roster, in_words, match, read_roster

STUDENT, ID, SECTION = 'Student', 'ID', 'Section'
NEEDED = (STUDENT, ID, SECTION)
LOGIN = 'SIS Login ID'
POINTS = 'Points Possible'
_ASSIGNMENT = re.compile(r'.+ \(\d+\)', re.DOTALL)
"""The heading of an assignment: its title, and its number in Canvas."""
HOW = "Take the gradebook's own table: in Canvas, Gradebook, Export, Export Entire Gradebook"


def make_table(
    course: Course, scores: AssignmentScores, roster_path: Path | None = None
) -> ImportFile:
    """Return the table to import; with Canvas's export, students and titles are taken from it.

    If the export has no column of that name, a note says so. Raises CourseError if the export
    can't be read, has several such columns, or gives an assignment other points.
    """
    if roster_path is None:
        return table_by_number(
            course,
            scores,
            'Canvas',
            download='Download submissions',
            headings=[*NEEDED, scores.assignment],
            row_of=lambda each, number: [each.student_id, number, '', each.score],
        )
    roster = read_roster(roster_path, NEEDED, HOW)
    numbers = StudentNumbers(course)

    people = [row for row in roster.rows if POINTS not in row[STUDENT]]
    column, notes = _column_of(scores.assignment, roster)
    _check_points(column, scores, roster)
    found = match(
        [each.student_id for each in scores.final],
        Roster(roster.path, roster.headings, tuple(people)),
        number_of=lambda student: numbers.of(student, scores.assignment).get('canvas'),
        number_in=lambda row: row[ID],
        name_of=lambda row: row[STUDENT],
        logins_in=lambda row: (row.get(LOGIN, ''), row[ID]),
    )
    about = roster.headings[: roster.headings.index(SECTION) + 1]
    rows: list[list[object]] = [[*about, column]]
    for each in scores.final:
        if row := found.rows.get(each.student_id):
            rows.append([*(row.get(heading, '') for heading in about), each.score])
    return ImportFile(spreadsheet_table(rows), len(rows) - 1, found.unclear, notes)


def _column_of(assignment: str, roster: Roster) -> tuple[str, tuple[str, ...]]:
    """Return an assignment's heading, such as '03_publisher (4711)', and a note if there is none.

    Without one it is the assignment's name: an assignment may be new in Canvas. Raises CourseError
    if there are several.
    """
    titled = re.compile(rf'{re.escape(assignment)}( \(\d+\))?', re.I)
    found = [heading for heading in roster.headings if titled.fullmatch(heading)]
    if len(found) > 1:
        raise CourseError(
            f'{roster.path} has several columns for {assignment}: {in_words(found)}. Expected '
            'one: rename the other assignment in Canvas, and export the gradebook again'
        )
    if found:
        return found[0], ()
    others = [heading for heading in roster.headings if _ASSIGNMENT.fullmatch(heading)]
    return assignment, (
        f"{roster.path.name} has no column '{assignment} (NUMBER)'. Its assignments: "
        f'{in_words(others)}. If one of them is meant, rename it to {assignment} in Canvas, '
        'export the gradebook again, and repeat this command, or choose it when Canvas imports '
        'the file and asks whether the assignment is new',
    )


def _check_points(column: str, scores: AssignmentScores, roster: Roster) -> None:
    """Check that the assignment gives as many points in Canvas. Raises CourseError."""
    given = [row.get(column, '') for row in roster.rows if POINTS in row[STUDENT]]
    for text in given:
        try:
            most = float(text.replace(',', '.'))
        except ValueError:  # not a number, for example if the column is new
            continue
        for each in scores.final[:1]:
            if most != each.max_score:
                raise CourseError(
                    f'{roster.path}: {column} gives {most:g} points in Canvas and '
                    f'{each.max_score:g} here: set its points to {each.max_score:g} in Canvas, '
                    'and export the gradebook again'
                )
