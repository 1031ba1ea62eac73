"""Results that are used again, because nothing that they depend on has changed since."""

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path

import nbformat
from my_robot_basics.validate.verdicts.verdict import SCORED
from nbformat import NotebookNode

from grader.common.versions import software_hash
from grader.course import Course
from grader.notebook.own_notebooks import parse_own_notebook
from grader.notebook.restore import KEY, grade_id, role
from grader.notebook.submission import TIMESTAMP, Submission
from grader.storage.database import open_database
from grader.storage.gradebook import StoredResult
from grader.storage.held_scores import auto_scores, held_score
from grader.storage.lateness import store_due_date
from grader.storage.pipeline import apply_preprocessors, first_reason, resources_of

LATE = ('grader.storage.late_penalties.LatePenalties',)
"""The penalty is computed again: a due date may have moved, and results don't depend on it."""
_UNDER, _FILES, _LESSON = 'graded_under', 'graded_files', 'graded_lesson'


def lesson_digest(course: Course, assignment: str) -> str:
    """Return a hash of a lesson, as it is in solutions/ and in notebooks/, without its outputs."""
    lesson = [
        _cells_without_outputs(course.source(assignment)),
        _cells_without_outputs(course.release(assignment)),
    ]
    return _digest(json.dumps(lesson, sort_keys=True).encode())


def conditions_digest(lesson: str, *, isolated: bool) -> str:
    """Return a hash of all that the results of all students depend on; `lesson` is its digest."""
    return _digest(json.dumps([lesson, isolated, software_hash()]).encode())


def key_of(submission: Submission, given: str, *, seed: str) -> str:
    """Return a hash of a submission's files, its seed, and the conditions of its assignment."""
    parts = [given, seed, submission.assignment, submission.problem or '', *submission.notes]
    parts += _digests(submission, with_notebook=submission.problem is None)
    return _digest(json.dumps(parts).encode())


def files_digest(submission: Submission) -> str:
    """Return a hash of a submission's files alone, also if its notebook can't be read."""
    return _digest(json.dumps(_digests(submission, with_notebook=True)).encode())


def write_key(graded: NotebookNode, key: str, files: str, lesson: str) -> None:
    """Write a key, and the hashes of files and lesson, into a graded notebook; it keeps them."""
    graded.metadata.setdefault(KEY, nbformat.from_dict({'notes': []})).update(
        {_UNDER: key, _FILES: files, _LESSON: lesson}
    )


def are_of_another_lesson(course: Course, assignment: str, graded: Iterable[Path]) -> bool:
    """Whether one of these graded notebooks is known to be of another version of its lesson."""
    now = lesson_digest(course, assignment)
    texts = (path.read_text(encoding='utf-8', errors='replace') for path in graded)
    return any(f'"{_LESSON}"' in text and now not in text for text in texts)


def is_of_other_files(course: Course, submission: Submission) -> bool:
    """Whether the stored result is not known to be of the files that the submission has now."""
    try:
        stored = parse_own_notebook(_graded_path(course, submission).read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return True
    return stored.metadata.get(KEY, {}).get(_FILES) != files_digest(submission)


def find_earlier_result(course: Course, submission: Submission, key: str) -> NotebookNode | None:
    """Return the graded notebook that is stored under a key, if each of its checks has a score."""
    try:
        text = _graded_path(course, submission).read_text(encoding='utf-8')
        notebook = parse_own_notebook(text) if key in text else None
    except (OSError, ValueError):
        return None  # not there yet, or damaged: it is graded again
    if notebook is None or notebook.metadata.get(KEY, {}).get(_UNDER) != key:
        return None
    return notebook if all(_outcomes(notebook).values()) else None


def refresh_late_penalty(
    course: Course, submission: Submission, graded: NotebookNode
) -> StoredResult | None:
    """Return what the gradebook holds for an earlier result, with the late penalty updated.

    Manual scores stay. Returns None if the gradebook's scores are not those of the result.
    """
    student, assignment = submission.student_id, submission.assignment
    with open_database(course.db_url) as book:
        former = now = held_score(book, student, assignment)
        if former is None or not _agree(auto_scores(book, student, assignment), graded):
            return None
        if store_due_date(course.gradebook, course.db_url, assignment, student):
            apply_preprocessors(LATE, graded, resources_of(course, assignment, student))
            now = held_score(book, student, assignment)
    assert now is not None  # as before
    return StoredResult(
        score=now.score,
        max_score=now.max_score,
        former=former.score,
        pending=now.pending,
        reason=first_reason(graded),
        late=now.late,
    )


def _agree(held: dict[str, float | None], graded: NotebookNode) -> bool:
    """Whether the stored scores are those of the notebook's verdicts."""
    outcomes = _outcomes(graded)
    cells = {grade_id(cell): cell.metadata for cell in _checks(graded)}
    return {name: score for name, score in held.items() if name in outcomes} == {
        name: cells[name].nbgrader.points
        if outcome == 'passed'
        else cells[name][KEY].get('earned', 0.0)
        for name, outcome in outcomes.items()
    }


def _outcomes(notebook: NotebookNode) -> dict[str, str]:
    """Return the outcome of each check by grade id; '' if it has no score."""
    found = {grade_id(c) or '': c.metadata.get(KEY, {}).get('outcome') for c in _checks(notebook)}
    return {name: said if said in SCORED else '' for name, said in found.items()}


def _checks(notebook: NotebookNode) -> list[NotebookNode]:
    return [cell for cell in notebook.cells if role(cell) == 'grade' and cell.cell_type == 'code']


def _cells_without_outputs(notebook: NotebookNode) -> list:
    """Return the cells of a lesson, without their outputs."""
    return [(c.cell_type, c.source, c.get('id'), c.metadata) for c in notebook.cells]


def _graded_path(course: Course, submission: Submission) -> Path:
    folder = course.folder('autograded', submission.student_id, submission.assignment)
    return folder / f'{submission.assignment}.ipynb'


def _digests(submission: Submission, *, with_notebook: bool) -> list[str]:
    files = {TIMESTAMP: submission.path.with_name(TIMESTAMP)} | submission.files
    if with_notebook:
        files[submission.path.name] = submission.path
    return [f'{name} {_digest(_content(path))}' for name, path in files.items()]


def _content(path: Path) -> bytes:
    return path.read_bytes() if path.is_file() and not path.is_symlink() else b''


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
