"""Statistics of one run: scores, checks, reasons, and what a person should look at."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import mean, median

from my_robot_basics.validate.lessons.titles import title_of_check
from nbformat import NotebookNode

from grader.course import Course
from grader.grading import SubmissionOutcome
from grader.notebook.restore import KEY, NO_ANSWERS, grade_id
from grader.report.message_groups import CellMessage, Reason, group_messages
from grader.storage.records import CellScore, graded_notebook, verdicts_in

WRITTEN = 'a written answer that a person reads'


@dataclass(frozen=True)
class CheckStatistics:
    """How a class did in one graded cell."""

    grade_id: str
    title: str
    points: float
    passed: int
    """How many students have all of its points."""
    missed: int
    waiting: int
    """How many students wait for manual grading."""
    why: Reason | None = None
    """The most common reason of those who missed points."""

    @property
    def rate(self) -> float:
        """Return the share of students with all points, among those with a score, 0 to 1."""
        return self.passed / max(1, self.passed + self.missed)

    @property
    def students(self) -> int:
        """Return how many students handed in."""
        return self.passed + self.missed + self.waiting


@dataclass(frozen=True)
class AssignmentStatistics:
    """How a class did in one assignment."""

    name: str
    version: str
    """A hash of the lesson's text."""
    max_score: float
    scores: tuple[float, ...]
    """The students' scores, the lowest first; what waits for manual grading counts 0."""
    checks: tuple[CheckStatistics, ...]

    @property
    def mean(self) -> float:
        """Return the mean score."""
        return mean(self.scores)

    @property
    def median(self) -> float:
        """Return the median score."""
        return median(self.scores)


@dataclass(frozen=True)
class Tally:
    """The statistics of one run; all text from students is printable."""

    assignments: tuple[AssignmentStatistics, ...]
    reasons: tuple[Reason, ...]
    """Why points are missing, the most common reason first."""
    looks: tuple[Reason, ...]
    """What a person should look at, by reason; answers that are only to be read come last."""

    @property
    def hardest(self) -> list[tuple[str, CheckStatistics]]:
        """Return assignment and check for checks with missed points, most missed first."""
        missed = [
            (each.name, check)
            for each in self.assignments
            for check in each.checks
            if check.missed
        ]
        return sorted(missed, key=lambda found: -found[1].missed / found[1].students)


@dataclass(frozen=True)
class _VerdictsOfOne:
    """The part of a graded notebook that is kept: whole notebooks would fill the memory."""

    problem: str
    verdicts: dict[str, dict]
    lost_answers: bool


def _verdicts_of(graded: NotebookNode) -> _VerdictsOfOne:
    ours = graded.metadata.get(KEY, {})
    lost = NO_ANSWERS in ours.get('notes', ())
    return _VerdictsOfOne(ours.get('problem') or '', verdicts_in(graded), lost)


def tally(course: Course, rows: Sequence[SubmissionOutcome], stored: Iterable[CellScore]) -> Tally:
    """Compute the statistics of one run's submissions; `stored` has all graded cells."""
    whose = {(row.student_id, row.assignment): row for row in rows if row.stored}
    of_cells = defaultdict(list)
    for record in stored:
        if (record.student_id, record.assignment) in whose:
            of_cells[record.student_id, record.assignment].append(record)
    said = {each: _verdicts_of(graded_notebook(course, *each)) for each in whose}
    failures = list(_failures(said))
    looks = group_messages(_find_manual_work(rows, of_cells, said))
    return Tally(
        assignments=tuple(_assignments(course, whose, of_cells, failures)),
        reasons=tuple(group_messages(failures)),
        looks=tuple(sorted(looks, key=lambda each: each.words == WRITTEN)),
    )


def _assignments(
    course: Course,
    whose: dict[tuple, SubmissionOutcome],
    of_cells: dict[tuple, list[CellScore]],
    failures: list[CellMessage],
) -> Iterable[AssignmentStatistics]:
    for name in sorted({assignment for _, assignment in whose}):
        stored = [
            row.stored
            for (_, assignment), row in whose.items()
            if assignment == name and row.stored
        ]
        cells = [
            r for (_, assignment), found in of_cells.items() if assignment == name for r in found
        ]
        titles = {grade_id(c): title_of_check(c.source) for c in course.source(name).cells}
        said = defaultdict(list)
        for failure in failures:
            if failure.assignment == name:
                said[failure.grade_id].append(failure)
        ids = dict.fromkeys(r.grade_id for r in cells if r.max_score)
        yield AssignmentStatistics(
            name=name,
            version=course.version(name)[:12],
            max_score=max(each.max_score for each in stored),
            scores=tuple(sorted(each.score for each in stored)),
            checks=tuple(
                _check([r for r in cells if r.grade_id == each], titles.get(each), said[each])
                for each in ids
            ),
        )


def _check(
    cells: list[CellScore], title: str | None, failures: list[CellMessage]
) -> CheckStatistics:
    scored = [record for record in cells if record.score is not None]
    passed = sum(each.score >= each.max_score for each in cells if each.score is not None)
    return CheckStatistics(
        grade_id=cells[0].grade_id,
        title=title or '',
        points=cells[0].max_score,
        passed=passed,
        missed=len(scored) - passed,
        waiting=len(cells) - len(scored),
        why=next(iter(group_messages(failures)), None),
    )


def _failures(all_said: dict[tuple[str, str], _VerdictsOfOne]) -> Iterable[CellMessage]:
    for whose, said in all_said.items():
        for name, verdict in said.verdicts.items():
            if verdict.get('outcome') in ('partial', 'failed'):
                yield CellMessage(
                    *whose, name, verdict.get('details') or verdict.get('reason', '')
                )


def _find_manual_work(
    rows: Sequence[SubmissionOutcome],
    of_cells: dict[tuple, list[CellScore]],
    all_said: dict[tuple[str, str], _VerdictsOfOne],
) -> Iterable[CellMessage]:
    for row in rows:
        whose = row.student_id, row.assignment
        if row.stored is None:
            yield CellMessage(*whose, '', row.reason)
            continue
        said = all_said[whose]
        if said.problem:
            yield CellMessage(*whose, '', f'unreadable, so it earned nothing: {said.problem}')
            continue
        if said.lost_answers:  # an answer that was not found may be right
            yield CellMessage(*whose, '', NO_ANSWERS)
        for record in of_cells[whose]:
            if record.score is None:
                reason = said.verdicts.get(record.grade_id, {}).get('reason') or WRITTEN
                yield CellMessage(*whose, record.grade_id, reason)
