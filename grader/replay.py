"""Grade again with given inputs, compare with the gradebook, and store nothing."""

from collections.abc import Iterator, Mapping, Sequence

from grader.common.argument_values import RECORDED
from grader.common.errors import CourseError
from grader.common.text import printable
from grader.course import Course
from grader.notebook.restore import KEY, grade_id, role
from grader.notebook.submission import read_submission
from grader.storage.pipeline import make_sanitized_template
from grader.storage.records import graded_notebook, verdicts
from grader.storage.seeds import seeds
from grader.storage.submitted import SubmissionFolder
from grader.workers.backend import Backend, submit_for_grading
from grader.workers.workers import Workers

_CHANGED = 'grading now uses another seed: the lesson was changed since'
_OTHER = 'this seed is not the one that grading uses'


def replay(
    course: Course,
    submissions: Sequence[SubmissionFolder],
    *,
    backend: Backend | None = None,
    seed: str = RECORDED,
    trust_students: bool = False,
) -> Iterator[tuple[str, bool]]:
    """Yield a line for each check of each submission, and whether its verdict is as stored.

    Raises CourseError if no seed is recorded.
    """
    found = [each for each in submissions if not each.problem]
    seeds = [recorded_seed(course, each) if seed == RECORDED else seed for each in found]
    templates = {
        name: make_sanitized_template(course, name) for name in {each.assignment for each in found}
    }
    packages = {name: course.packages(name) for name in templates}
    with backend or Workers() as backend:
        backend.require_isolation(trust_students=trust_students)
        work = [
            submit_for_grading(
                read_submission(
                    each.folder,
                    student_id=each.student_id,
                    assignment=each.assignment,
                    packages=packages[each.assignment],
                ),
                templates[each.assignment],
                backend=backend,
                seed=its,
                trust_students=trust_students,
            )
            for each, its in zip(found, seeds, strict=True)
        ]
        for each, its, result in zip(found, seeds, work, strict=True):
            yield f'{printable(each.student_id)}  {each.assignment}  seed {its}', True
            if its != _own_seed(course, each):
                yield f'  ({_CHANGED if seed == RECORDED else _OTHER})', True
            stored = verdicts(course, each.student_id, each.assignment)
            for cell in result.result().notebook.cells:
                if role(cell) == 'grade' and cell.cell_type == 'code':
                    yield _compare_verdicts(grade_id(cell) or '', cell.metadata[KEY], stored)


def recorded_seed(course: Course, found: SubmissionFolder) -> str:
    """Return the seed of a submission's stored result. Raises CourseError if there is none."""
    graded = graded_notebook(course, found.student_id, found.assignment)
    about = graded.metadata.get(KEY, {})
    its_own = _own_seed(course, found)
    seed = its_own if 'problem' in about else about.get('seed')
    if not seed:
        raise CourseError(
            f'no seed is recorded for {found.assignment} of {found.student_id}: it was not '
            'graded yet. Give a seed: --seed HEX'
        )
    return seed


def _own_seed(course: Course, found: SubmissionFolder) -> str:
    """Return the seed that grading this submission would use now."""
    submission = read_submission(
        found.folder,
        student_id=found.student_id,
        assignment=found.assignment,
        packages=course.packages(found.assignment),
    )
    return seeds(course, found.assignment)(submission)


def _compare_verdicts(name: str, now: Mapping, stored: Mapping[str, Mapping]) -> tuple[str, bool]:
    then = stored.get(name, {})
    same = all(
        (now.get(key) or None) == (then.get(key) or None)
        for key in ('outcome', 'reason', 'earned')
    )
    line = f'  {name}  {_describe(now)}'
    return (f'{line}  as stored', True) if same else (f'{line}  STORED: {_describe(then)}', False)


def _describe(verdict: Mapping) -> str:
    said = verdict.get('outcome') or 'nothing'
    reason = verdict.get('details') or verdict.get('reason')
    return printable(f'{said}: {reason}' if reason else said)
