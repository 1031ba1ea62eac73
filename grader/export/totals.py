"""The whole course in one table: a row for each student, a column for each assignment."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from grader.common.files import write_whole
from grader.common.points import sum_points
from grader.common.text import spreadsheet_table
from grader.course import Course
from grader.storage.records import CellScore, records


@dataclass(frozen=True)
class StudentTotal:
    """A student's scores so far."""

    student_id: str
    scores: tuple[float | None, ...]
    """For each assignment, with late penalties subtracted; None if nothing was handed in."""
    waiting: int
    """How many graded cells wait for manual grading; they count 0 until then."""

    @property
    def total(self) -> float:
        """Return the sum over all assignments."""
        return sum_points(score for score in self.scores if score is not None)


@dataclass(frozen=True)
class Totals:
    """The scores of all students in all assignments."""

    assignments: tuple[str, ...]
    max_scores: tuple[float, ...]
    """The highest possible score of each assignment."""
    students: tuple[StudentTotal, ...]

    @property
    def max_score(self) -> float:
        """Return the highest possible score of the whole course."""
        return sum(self.max_scores)


def add_up(found: Iterable[CellScore]) -> Totals:
    """Add up graded cells, including those of assignments that a student did not hand in."""
    by_student: dict[str, dict[str, list[CellScore]]] = defaultdict(lambda: defaultdict(list))
    for record in found:
        by_student[record.student_id][record.assignment].append(record)
    max_scores = {
        assignment: sum(cell.max_score for cell in cells)
        for lessons in by_student.values()
        for assignment, cells in lessons.items()
    }
    assignments = sorted(max_scores)
    return Totals(
        assignments=tuple(assignments),
        max_scores=tuple(max_scores[each] for each in assignments),
        students=tuple(
            StudentTotal(
                student_id=student,
                scores=tuple(_score(lessons[each]) for each in assignments),
                waiting=sum(_waits(cell) for cells in lessons.values() for cell in cells),
            )
            for student, lessons in sorted(by_student.items())
        ),
    )


def write_totals(course: Course) -> Path:
    """Write gradebook/totals.csv, a row for each student; return its path.

    A score is empty if nothing was handed in; `waiting` counts cells that wait for manual grading.
    """
    path = course.gradebook / 'totals.csv'
    write_whole(path, as_csv(add_up(records(course))))
    return path


def as_csv(totals: Totals) -> str:
    """Return the table for a spreadsheet."""
    most = zip(totals.assignments, totals.max_scores, strict=True)
    heads = [f'{assignment} (of {points:g})' for assignment, points in most]
    rows: list[list[object]] = [
        ['student_id', *heads, f'total (of {totals.max_score:g})', 'waiting']
    ]
    for each in totals.students:
        scores = ['' if score is None else score for score in each.scores]
        rows.append([each.student_id, *scores, each.total, each.waiting])
    return spreadsheet_table(rows)


def _score(cells: list[CellScore]) -> float | None:
    handed_in = [cell for cell in cells if cell.submitted]
    return sum_points(cell.score or 0.0 for cell in handed_in) if handed_in else None


def _waits(cell: CellScore) -> bool:
    return cell.submitted and cell.score is None
