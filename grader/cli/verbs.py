"""What `./course VERB` does and prints: a function for each verb, which returns the status."""

import argparse
from datetime import datetime

from grader.authoring.bundle import bundle
from grader.authoring.release import release
from grader.cli.demo import demo
from grader.collect.collect import LEFT, collect
from grader.collect.collect_table import lines
from grader.common.errors import CourseError
from grader.common.text import printable
from grader.course import Course
from grader.export.sample_solutions import write_solutions
from grader.export.scores import write_scores
from grader.export.totals import write_totals
from grader.grade import grade_all
from grader.kernels.isolation import (
    NO_SANDBOX,
    accounting,
    missing,
    protections,
    require_isolation,
    slow,
)
from grader.replay import RECORDED, replay
from grader.report.feedback import write_feedback
from grader.report.progress_table import changes, print_rows
from grader.report.report import Run, write_report
from grader.storage.database import wait_until_free
from grader.storage.due_dates import describe_deadlines, set_due
from grader.storage.gradebook import register
from grader.storage.late_penalties import extended_for_nobody
from grader.storage.submitted import SubmissionFolder, find_submissions
from grader.workers.backend import Backend
from grader.workers.dask_backend import Cluster
from grader.workers.dask_client import Certificates
from grader.workers.workers import Workers

NO_DATE = 'none'
"""Stands for a due date that is taken back."""


def run_release(course: Course, asked: argparse.Namespace) -> int:
    """Write notebooks/ anew, and name the files that have changed."""
    wanted = [asked.assignment] if asked.assignment else course.assignments()
    if course.database.exists():
        for assignment in wanted:
            register(course, assignment)  # refuses what graded submissions can't follow
    changed = release(
        course, asked.assignment or '*', fresh_outputs=asked.fresh_outputs, say=print
    )
    for path in changed:
        print(f'notebooks/{path}')
    print(f'{len(changed)} files changed.' if changed else 'Nothing has changed.')
    return 0


def run_bundle(course: Course, asked: argparse.Namespace) -> int:
    """Make the zip that students get, and say what it leaves out."""
    made = bundle(course, asked.file)
    for path in made.left_out:
        print(f'left out: {path}')
    print(f'{asked.file}: {len(made.files)} files, {made.bytes / 1e6:.1f} MB')
    return 0


def run_collect(course: Course, asked: argparse.Namespace) -> int:
    """Take in submissions, a line for each file. 1 where none was taken or one wants a look."""
    rows = list(collect(course, asked.source, file_times=asked.file_times))
    for line in lines(rows):
        print(line)
    taken = any(row.student_id for row in rows)
    if taken:
        print('Next: ./course grade')
    return 0 if taken and not any(row.outcome == LEFT for row in rows) else 1


def run_due(course: Course, asked: argparse.Namespace) -> int:
    """Set a due date or an extension where one is given, and list all of them."""
    if asked.assignment:
        if asked.when is None:
            raise CourseError(
                f'say until when: ./course due {asked.assignment} 2026-11-30, or none for no date'
            )
        when = None if asked.when == NO_DATE else asked.when
        set_due(course, asked.assignment, when, student_id=asked.student)
    for line in (*describe_deadlines(course), *extended_for_nobody(course)):
        print(line)
    return 0


def run_grade(course: Course, asked: argparse.Namespace) -> int:
    """Grade, a row for each submission, and write the report. 1 where one could not be graded."""
    backend = _crew(asked)
    submissions = find_submissions(course, assignment=asked.assignment, student_id=asked.student)
    if asked.store and asked.seed == RECORDED:
        raise CourseError('--store needs --seed HEX: what is recorded is stored already')
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
    rows = []
    if asked.trust_students and not require_isolation(trust_students=True):
        print(f'{NO_SANDBOX.capitalize()}, and student code has your rights (--trust-students).')
    try:
        for row in print_rows(graded, submissions):
            rows.append(row)
    except KeyboardInterrupt:
        graded.close()  # ends all that runs, before anybody is told so
        told = f'{len(rows)} of {len(submissions)} submissions are graded and stored'
        raise KeyboardInterrupt(told) from None
    report = write_report(course, run, rows)
    if changed := changes(rows):
        print(f'{len(changed)} score{"s" * (len(changed) > 1)} changed:')
        print(*(f'  {line}' for line in changed), sep='\n')
    for line in extended_for_nobody(course):
        print(line)
    failed = sum(row.stored is None for row in rows)
    waiting = sum(row.stored is not None and row.stored.pending for row in rows)
    print(
        f'{len(rows) - failed} graded, {waiting} of them wait for a person (…), '
        f'{failed} could not be graded (–).\n'
        f'Report: {report}\nNext: ./course feedback, ./course scores'
    )
    return 1 if failed else 0


def _crew(asked: argparse.Namespace) -> Backend | None:
    certificates = Certificates(asked.tls_ca_file, asked.tls_cert, asked.tls_key)
    if not asked.dask:
        if certificates != Certificates():
            raise CourseError('--tls-ca-file, --tls-cert and --tls-key go with --dask tls://…')
        return Workers(asked.workers) if asked.workers else None
    if asked.trust_students:
        raise CourseError(
            '--trust-students and --dask do not go together: a worker without a sandbox would '
            'run what students wrote with the rights of all the cluster'
        )
    return Cluster(asked.dask, certificates)


def _replay(
    course: Course,
    submissions: list[SubmissionFolder],
    asked: argparse.Namespace,
    backend: Backend | None,
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
    print('Nothing was stored; --store stores it.')
    return 0 if same else 1


def run_scores(course: Course, asked: argparse.Namespace) -> int:
    """Write a table of scores, and say where it lies."""
    _wait_for_database(course)
    print(write_totals(course) if asked.totals else write_scores(course))
    _say_what_comes_first(course)
    return 0


def run_solutions(course: Course, asked: argparse.Namespace) -> int:
    """Write notebooks with the answers, to give out after the deadline."""
    wanted = [asked.assignment] if asked.assignment else ()
    for path in write_solutions(course, wanted, early=asked.early):
        print(path)
    return 0


def run_feedback(course: Course, asked: argparse.Namespace) -> int:
    """Write the pages of feedback, and say where they lie."""
    _wait_for_database(course)
    pages = write_feedback(course, say=lambda line: print(printable(line)))
    print(f'{len(pages)} pages in {course.folder("feedback", "", "")}')
    _say_what_comes_first(course)
    return 0


def _wait_for_database(course: Course) -> None:
    if course.database.exists():
        wait_until_free(course)


def _say_what_comes_first(course: Course) -> None:
    if not any(course.folder('autograded', '', '').glob('*/*/*.ipynb')):
        print('Nothing is graded yet. Next: ./course grade')


def run_demo(course: Course, asked: argparse.Namespace) -> int:
    """Grade the sample class. 1 where a notebook does not come out as it is named."""
    return 0 if demo(root=course.root) else 1


def run_doctor(course: Course, asked: argparse.Namespace) -> int:
    """Print what isolates student code on this machine. Return 1 if something is missing."""
    print('What isolates student code while it is graded:')
    counted = accounting()
    for protection in (*protections(), counted):
        lacks = 'without' if protection is counted else 'MISSING'
        print(f'  {lacks if protection.problem else "ok     "}  {protection.name}')
    if problem := missing():
        print(f'\n{problem[0].upper()}{problem[1:]}.')
        return 1
    print('Nothing is missing: ./course grade runs each submission in a sandbox.')
    if counted.problem:
        print(
            f'Its limits are less strict than they could be: {counted.problem}. {counted.remedy}.'
        )
    if problem := slow():
        print(f'It is slower than it could be: no kernel can be forked here, for {problem}.')
    return 0
