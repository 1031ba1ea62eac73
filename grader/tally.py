"""What one run says of a class: scores, checks, reasons, and what a person should look at."""

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import mean, median

from nbformat import NotebookNode

from grader.course import Course
from grader.grade import Row
from grader.heal import KEY, grade_id
from grader.page import docstring
from grader.records import Record, graded_notebook, records
from grader.text import printable

NUMBER = re.compile(r'(?<!\w)[-+]?\d+(\.\d+)?(e[-+]?\d+)?(?!\w)')
_MANY = re.compile(r'…(, …)+')


@dataclass(frozen=True)
class Check:
    """How a class did in one graded cell."""

    grade_id: str
    title: str
    points: float
    passed: int
    """Students with all of its points."""
    missed: int
    waiting: int
    """Students whose score a person has to decide."""

    @property
    def rate(self) -> float:
        """Return the share of those with a score who got all points, 0 to 1."""
        return self.passed / max(1, self.passed + self.missed)


@dataclass(frozen=True)
class Assignment:
    """How a class did in one assignment."""

    name: str
    version: str
    """Of the lesson's text."""
    max_score: float
    scores: tuple[float, ...]
    """Of each student, the lowest first; what waits for a person counts 0."""
    checks: tuple[Check, ...]

    @property
    def mean(self) -> float:
        """Return the mean score."""
        return mean(self.scores)

    @property
    def median(self) -> float:
        """Return the median score."""
        return median(self.scores)


@dataclass(frozen=True)
class Reason:
    """Why points are missing, for all students for whom it is the same but for numbers."""

    assignment: str
    words: str
    """The reason, with … for its numbers where those differ."""
    example: str
    students: tuple[str, ...]
    checks: tuple[str, ...]


@dataclass(frozen=True)
class Look:
    """Something that a person should look at."""

    student_id: str
    assignment: str
    why: str


@dataclass(frozen=True)
class Tally:
    """What one run says of a class; everything that students wrote is printable text."""

    assignments: tuple[Assignment, ...]
    reasons: tuple[Reason, ...]
    """The most common one first."""
    looks: tuple[Look, ...]


def tally(course: Course, rows: Sequence[Row]) -> Tally:
    """Count what came of the submissions of one run."""
    whose = {(row.student_id, row.assignment): row for row in rows if row.stored}
    of_cells = defaultdict(list)
    for record in records(course, only=whose.keys()):
        of_cells[record.student_id, record.assignment].append(record)
    notebooks = {each: graded_notebook(course, *each) for each in whose}
    return Tally(
        assignments=tuple(_assignments(course, whose, of_cells)),
        reasons=tuple(_reasons(notebooks)),
        looks=tuple(_looks(rows, of_cells, notebooks)),
    )


def numberless(reason: str) -> str:
    """Return a reason with … in the place of its numbers, and of lists of them."""
    return _MANY.sub('…', NUMBER.sub('…', reason))


def _assignments(
    course: Course, whose: dict[tuple, Row], of_cells: dict[tuple, list[Record]]
) -> Iterable[Assignment]:
    for name in sorted({assignment for _, assignment in whose}):
        stored = [row.stored for (_, assignment), row in whose.items() if assignment == name]
        cells = [
            r for (_, assignment), found in of_cells.items() if assignment == name for r in found
        ]
        titles = {grade_id(c): docstring(c.source) for c in course.source(name).cells}
        ids = dict.fromkeys(r.grade_id for r in cells if r.max_score)
        yield Assignment(
            name=name,
            version=course.version(name)[:12],
            max_score=max(each.max_score for each in stored),
            scores=tuple(sorted(each.score for each in stored)),
            checks=tuple(
                _check([r for r in cells if r.grade_id == each], titles.get(each)) for each in ids
            ),
        )


def _check(cells: list[Record], title: str | None) -> Check:
    scored = [record for record in cells if record.score is not None]
    passed = sum(record.score >= record.max_score for record in scored)
    return Check(
        grade_id=cells[0].grade_id,
        title=title or '',
        points=cells[0].max_score,
        passed=passed,
        missed=len(scored) - passed,
        waiting=len(cells) - len(scored),
    )


def _reasons(notebooks: dict[tuple[str, str], NotebookNode]) -> list[Reason]:
    found = defaultdict(list)
    for (student, assignment), notebook in notebooks.items():
        for name, verdict in _verdicts(notebook).items():
            if verdict.get('outcome') == 'failed':
                said = printable(verdict.get('reason', ''))
                found[assignment, numberless(said)].append((printable(student), name, said))
    reasons = [
        Reason(
            assignment=assignment,
            words=said[0][2] if len({text for *_, text in said}) == 1 else words,
            example=said[0][2],
            students=tuple(dict.fromkeys(student for student, _, _ in said)),
            checks=tuple(dict.fromkeys(name for _, name, _ in said)),
        )
        for (assignment, words), said in found.items()
    ]
    return sorted(reasons, key=lambda each: (-len(each.students), each.assignment, each.words))


def _looks(
    rows: Sequence[Row],
    of_cells: dict[tuple, list[Record]],
    notebooks: dict[tuple[str, str], NotebookNode],
) -> Iterable[Look]:
    for row in rows:
        whose = printable(row.student_id), printable(row.assignment)
        if row.stored is None:
            yield Look(*whose, printable(row.reason))
            continue
        notebook = notebooks[row.student_id, row.assignment]
        if problem := notebook.metadata.get(KEY, {}).get('problem'):
            yield Look(*whose, f'unreadable, so it earned nothing: {printable(problem)}')
            continue
        verdicts = _verdicts(notebook)
        for record in of_cells[row.student_id, row.assignment]:
            if record.score is None:
                said = verdicts.get(record.grade_id, {})
                reason = said.get('reason') or 'a written answer that a person reads'
                yield Look(*whose, f'{record.grade_id}: {printable(reason)}')


def _verdicts(notebook: NotebookNode) -> dict[str, dict]:
    return {grade_id(c): c.metadata.get(KEY, {}) for c in notebook.cells if grade_id(c)}
