"""The work and output of `./course grade`: grade, or grade again with a seed and compare."""

import argparse
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime

from grader.common.argument_values import RECORDED
from grader.common.errors import CourseError
from grader.course import Course
from grader.grade import grade_all
from grader.grading import SubmissionOutcome
from grader.kernels.isolation import (
    NO_SANDBOX,
    require_isolation,
)
from grader.replay import replay
from grader.report.progress_table import changes, print_rows
from grader.report.report import Run, write_report
from grader.storage.database import share_engine
from grader.storage.deadlines import extended_for_nobody
from grader.storage.submitted import SubmissionFolder
from grader.workers.backend import Backend

_NOT_STORED = 'Nothing was stored; --store stores it.'
_AGAIN = (
    '{} of these because a check could not decide: ./course grade grades {} again, best while '
    'nothing else keeps the machine busy.\n'
)
_BY_HAND = 'points by hand (.venv/bin/jupyter lab, menu Nbgrader, Formgrader), '


def grade_and_report(
    course: Course,
    asked: argparse.Namespace,
    submissions: Sequence[SubmissionFolder],
    backend: Backend,
) -> int:
    """Grade, print a row for each submission, write the report; return 1 if one was not graded."""
    with share_engine(course.db_url):
        return _grade_and_report(course, asked, submissions, backend)


def _grade_and_report(
    course: Course,
    asked: argparse.Namespace,
    submissions: Sequence[SubmissionFolder],
    backend: Backend,
) -> int:
    if asked.store and asked.seed == RECORDED:
        raise CourseError(
            '--store needs --seed HEX: scores with recorded seeds are stored already'
        )
    if asked.store and not asked.seed:
        raise CourseError('--store needs --seed HEX: ./course grade alone stores what it finds')
    if asked.seed and not asked.store:
        return _replay(course, submissions, asked, backend)
    run = Run(datetime.now().astimezone(), seed=asked.seed or '')
    graded = grade_all(
        course,
        submissions,
        backend=backend,
        seed=asked.seed or '',
        trust_students=asked.trust_students,
        force=asked.force,
    )
    by_submission: dict[tuple[str, str], SubmissionOutcome] = {}
    if asked.trust_students and not require_isolation(trust_students=True):
        print(f'{NO_SANDBOX.capitalize()}, and student code has your rights (--trust-students).')
    try:
        for _ in print_rows(_recorded(graded, by_submission), submissions):
            pass
    except KeyboardInterrupt:
        graded.close()  # start nothing more, and end what runs, before the summary is printed
        summary = f'{len(by_submission)} of {len(submissions)} submissions are graded and stored'
        raise KeyboardInterrupt(summary) from None
    rows = [*by_submission.values()]
    report = write_report(course, run, rows, language=asked.language)
    if changed := changes(rows):
        print(f'{len(changed)} score{"s" * (len(changed) > 1)} changed:')
        print(*(f'  {line}' for line in changed), sep='\n')
    for line in extended_for_nobody(course):
        print(line)
    failed = sum(row.stored is None for row in rows)
    reused = sum(row.reused for row in rows)
    waiting = sum(row.stored is not None and row.stored.pending for row in rows)
    undecided = sum(row.may_be_decided for row in rows)
    again = _AGAIN.format(undecided, 'it' if undecided == 1 else 'them') if undecided else ''
    print(
        f'{len(rows) - failed - reused} graded, {reused} unchanged, {failed} could not be graded '
        f'(–); {waiting} wait for a person (…).\n{again}'
        f'Report: {report}\nNext: {_BY_HAND * bool(waiting)}./course feedback, ./course scores'
    )
    return 1 if failed else 0


def _recorded(
    rows: Iterable[SubmissionOutcome], by_submission: dict[tuple[str, str], SubmissionOutcome]
) -> Iterator[SubmissionOutcome]:
    """Yield rows, each recorded before it is printed: it counts if Ctrl-C comes right after that.

    A second row of a submission replaces the first.
    """
    for row in rows:
        by_submission[row.student_id, row.assignment] = row
        yield row


def _replay(
    course: Course,
    submissions: Sequence[SubmissionFolder],
    asked: argparse.Namespace,
    backend: Backend,
) -> int:
    same = True
    for line, as_stored in replay(
        course,
        submissions,
        backend=backend,
        seed=asked.seed,
        trust_students=asked.trust_students,
    ):
        print(line, flush=True)
        same &= as_stored
    print('The same as in the gradebook.' if same else 'NOT the same as in the gradebook.')
    # recorded seeds give the stored scores, and --store refuses them
    print('Nothing was stored.' if asked.seed == RECORDED else _NOT_STORED)
    return 0 if same else 1
