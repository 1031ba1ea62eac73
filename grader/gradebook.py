"""The only writer of nbgrader's database: lessons, scores, executed notebooks."""

import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import nbformat
from nbformat import NotebookNode
from nbgrader.api import Grade, Gradebook, MissingEntry, SubmittedNotebook
from nbgrader.preprocessors import SaveAutoGrades
from nbgrader.utils import parse_utc

from grader.course import Course
from grader.errors import CourseError
from grader.heal import KEY, grade_id
from grader.pipeline import apply, finish, first_reason, resources_of
from grader.release import PASSES
from grader.submission import Submission

SAVE_CELLS = 'nbgrader.preprocessors.SaveCells'
NO_ANSWER = 'there is no answer'
"""Why a text that a person would have graded earns nothing."""


@dataclass(frozen=True)
class Stored:
    """What the gradebook holds for a submission, once it was graded."""

    score: float
    max_score: float
    former: float | None
    """The score before, if there was one."""
    pending: bool
    """Whether some of it waits for a person."""
    reason: str
    """Why points are missing: the first reason, or ''."""


class SaveGrades(SaveAutoGrades):
    """Store the verdicts of one notebook, all of them or none.

    nbgrader reads a score off a cell's outputs, and a cell without any would earn its points. So a
    verdict is wanted too: without one the cell has no score and waits for a person.
    """

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Store the scores of a notebook that was executed."""
        at = resources['nbgrader']
        self.notebook_id, self.assignment_id = at['notebook'], at['assignment']
        self.student_id, self.db_url = at['student'], at['db_url']
        dated = {'timestamp': at['timestamp']} if at.get('timestamp') else {}
        with _one_transaction(self.db_url) as self.gradebook:
            self.gradebook.update_or_create_student(self.student_id)
            with self.gradebook.db.no_autoflush:  # it warns of what is half built meanwhile
                self.gradebook.update_or_create_submission(
                    self.assignment_id, self.student_id, **dated
                )
            for index, cell in enumerate(nb.cells):
                self.preprocess_cell(cell, resources, index)
        return nb, resources

    def _add_score(self, cell: NotebookNode, resources: dict) -> None:
        super()._add_score(cell, resources)
        grade = self.gradebook.find_grade(
            grade_id(cell), self.notebook_id, self.assignment_id, self.student_id
        )
        verdict = cell.metadata.setdefault(KEY, nbformat.from_dict({}))
        if cell.cell_type == 'code' and verdict.get('outcome') not in ('passed', 'failed'):
            grade.auto_score, grade.needs_manual_grade = None, True
        elif cell.cell_type != 'code' and grade.auto_score is not None:
            # nobody has to read what nobody wrote
            verdict |= {'outcome': 'failed', 'reason': NO_ANSWER, 'notes': []}


def make_ready(course: Course) -> None:
    """Make the gradebook's folder, and let nbgrader find the command that makes its database."""
    course.gradebook.mkdir(parents=True, exist_ok=True)
    programs = os.environ.get('PATH', os.defpath).split(os.pathsep)
    ours = str(Path(sys.executable).parent)  # where `alembic` is
    if ours not in programs:
        os.environ['PATH'] = os.pathsep.join([ours, *programs])


def register(course: Course, assignment: str) -> bool:
    """Tell the database what an assignment consists of; return whether that was news to it.

    Raises CourseError when cells came or went although submissions are graded already.
    """
    resources = resources_of(course, assignment)
    tidied = apply(PASSES[: PASSES.index(SAVE_CELLS)], course.source(assignment), resources)
    make_ready(course)
    with Gradebook(course.db_url) as book:
        known = _checksums_in(book, assignment)
        wanted = {
            grade_id(cell): cell.metadata['nbgrader']['checksum']
            for cell in tidied.cells
            if 'checksum' in cell.metadata.get('nbgrader', {})
        }
        if known == wanted:
            return False
        came, went = (
            sorted(wanted.keys() - (known or wanted)),
            sorted((known or {}).keys() - wanted),
        )
        if (came or went) and book.assignment_submissions(assignment):
            raise CourseError(
                f"{assignment} can't be changed like this after submissions were graded "
                f'(new cells: {", ".join(came) or "none"}; gone: {", ".join(went) or "none"}): '
                'give the cells their former grade ids, or keep this gradebook/ elsewhere and '
                'begin a new one.'
            )
        book.update_or_create_assignment(assignment)
    apply((SAVE_CELLS,), tidied, resources)
    return True


def register_before_autograde(*, assignment: str, **_: object) -> None:
    """Register what `nbgrader autograde`, which runs in the course's folder, is going to grade."""
    course = Course.at(Path.cwd())
    for name in course.assignments() if assignment == '*' else [assignment]:
        register(course, name)


def store(course: Course, submission: Submission, graded: NotebookNode) -> Stored:
    """Store an executed notebook: its scores, and the notebook itself under autograded/.

    The same nbgrader passes do it as in `nbgrader autograde`. Manual scores stay, the submitted
    files are only read, and storing twice is the same as once.
    """
    student, assignment = submission.student_id, submission.assignment
    at = resources_of(course, assignment, student)
    at['nbgrader']['timestamp'], notes = _handed_in(submission)
    graded = nbformat.from_dict(graded)
    graded.metadata.setdefault(KEY, nbformat.from_dict({'notes': []})).notes += notes
    former = _find(course, submission)
    folder = course.folder('autograded', student, assignment)
    folder.mkdir(parents=True, exist_ok=True)
    saved = finish(graded, at)
    write_whole(folder / f'{assignment}.ipynb', nbformat.writes(saved))
    for extra in (*submission.extra_files, *_timestamps(submission)):
        copy = folder / extra.name
        copy.unlink(missing_ok=True)
        shutil.copy(extra, copy)
    now = _find(course, submission)
    return Stored(
        score=now[0],
        max_score=now[1],
        former=former[0] if former else None,
        pending=now[2],
        reason=first_reason(saved),
    )


@contextmanager
def opened(course: Course) -> Iterator[Gradebook]:
    """Open the database to read in it; every assignment of the course is known to it then."""
    for assignment in course.assignments():
        register(course, assignment)
    with Gradebook(course.db_url) as book:
        yield book


def submitted_notebook(
    book: Gradebook, student_id: str, assignment: str
) -> SubmittedNotebook | None:
    """Return what the database holds of a submission, if there is one."""
    try:
        return book.find_submission_notebook(assignment, assignment, student_id)
    except MissingEntry:
        return None


def waits_for_a_person(grade: Grade) -> bool:
    """Whether nobody has given a score yet."""
    return grade.auto_score is None and grade.manual_score is None


def write_whole(path: Path, text: str) -> None:
    """Write a file so that nobody ever finds half of it."""
    aside = path.with_name(f'.{path.name}.new')
    aside.write_text(text, encoding='utf-8', newline='')
    os.replace(aside, path)


@contextmanager
def _one_transaction(db_url: str) -> Iterator[Gradebook]:
    """Open the database; what nbgrader would commit cell by cell is committed at the end."""
    with Gradebook(db_url) as book:
        commit, book.db.commit = book.db.commit, book.db.flush
        yield book
        commit()


def _checksums_in(book: Gradebook, assignment: str) -> dict[str, str] | None:
    try:
        cells = book.find_notebook(assignment, assignment).source_cells
    except MissingEntry:
        return None
    return {cell.name: cell.checksum for cell in cells}


def _find(course: Course, submission: Submission) -> tuple[float, float, bool] | None:
    """Return score, most that can be had, and whether a person has to look; None if not graded."""
    with Gradebook(course.db_url) as book:
        found = submitted_notebook(book, submission.student_id, submission.assignment)
        if found is None:
            return None
        waits = any(waits_for_a_person(grade) for grade in found.grades)
        return found.score - (found.late_submission_penalty or 0), found.max_score, waits


def _timestamps(submission: Submission) -> list[Path]:
    """Return nbgrader's timestamp.txt, if it lies beside the notebook."""
    path = submission.path.with_name('timestamp.txt')
    return [path] if path.is_file() and not path.is_symlink() else []


def _handed_in(submission: Submission) -> tuple[datetime | None, list[str]]:
    """Read when it was handed in (UTC) and what is wrong with that file."""
    if not (found := _timestamps(submission)):
        return None, []
    try:
        return parse_utc(found[0].read_text(encoding='utf-8').strip() or None), []
    except (ValueError, OverflowError):
        return None, ['timestamp.txt holds no date: counted as handed in on time']
