"""The scores of an assignment that are final."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from grader.common.points import sum_points
from grader.storage.records import CellScore


@dataclass(frozen=True)
class FinalScore:
    """A student's score in an assignment, with late penalties subtracted."""

    student_id: str
    score: float
    max_score: float


@dataclass(frozen=True)
class AssignmentScores:
    """The scores of one assignment."""

    assignment: str
    final: tuple[FinalScore, ...]
    waiting: tuple[str, ...]
    """Students of whom a part waits for manual grading."""


def final_scores(found: Iterable[CellScore], assignment: str = '') -> list[AssignmentScores]:
    """Add up graded cells, of one assignment or all, for students who handed in."""
    cells: dict[str, dict[str, list[CellScore]]] = defaultdict(lambda: defaultdict(list))
    for each in found:
        if each.submitted and assignment in ('', each.assignment):
            cells[each.assignment][each.student_id].append(each)
    return [_of_assignment(name, cells[name]) for name in sorted(cells)]


def _of_assignment(name: str, by_student: dict[str, list[CellScore]]) -> AssignmentScores:
    final, waiting = [], []
    for student, cells in sorted(by_student.items()):
        scores = [each.score for each in cells if each.score is not None]
        if len(scores) < len(cells):
            waiting.append(student)
        else:
            most = sum(each.max_score for each in cells)
            final.append(FinalScore(student, sum_points(scores), most))
    return AssignmentScores(name, tuple(final), tuple(waiting))
