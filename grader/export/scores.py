"""Export the gradebook as a table for spreadsheets and other systems."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from my_robot_basics.validate.lessons.cells import KEY

from grader.common.files import write_whole
from grader.common.text import spreadsheet_table
from grader.course import Course
from grader.kernels.isolation import NO_SANDBOX
from grader.storage.records import CellScore, graded_notebook, records, verdicts_in
from grader.storage.rewritten_answers import reason_today

COLUMNS = ('student_id', 'assignment', 'grade_id', 'score', 'max_score', 'comment')


def write_scores(course: Course) -> Path:
    """Write gradebook/scores.csv: a row for each student and graded cell; return its path.

    The score is empty if nothing was handed in or if it waits for manual grading; the comment says
    which.
    """
    path = course.gradebook / 'scores.csv'
    write_whole(path, as_csv(course, records(course)))
    return path


def as_csv(course: Course, found: Iterable[CellScore]) -> str:
    """Return the table of some graded cells, with the reasons of the checks."""
    return spreadsheet_table([COLUMNS, *_rows(course, found)])


def _rows(course: Course, found: Iterable[CellScore]) -> Iterator[tuple]:
    said: dict[str, dict] = {}
    whose, remark = None, ''
    for record in found:
        if whose != (whose := (record.student_id, record.assignment)):
            graded = graded_notebook(course, *whose)
            said = verdicts_in(graded)
            remark = '' if graded.metadata.get(KEY, {}).get('in_sandbox', True) else NO_SANDBOX
        yield (
            record.student_id,
            record.assignment,
            record.grade_id,
            '' if record.score is None else record.score,
            record.max_score,
            _comment(record, said.get(record.grade_id, {}), remark),
        )


def _comment(record: CellScore, verdict: dict, remark: str) -> str:
    """Explain in words why a cell has its score."""
    if not record.submitted:
        return 'not submitted'
    parts = [
        'to be graded by hand' if record.score is None else '',
        'scored by hand' if record.by_hand else '',
        record.comment,
        reason_today(verdict, by_hand=record.by_hand),
        *verdict.get('notes', ()),
        remark,
    ]
    return '; '.join(part for part in parts if part)
