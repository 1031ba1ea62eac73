"""The work and output of `./course VERB`: a function for each verb, which returns the status.

Each function imports what it needs, so that `--help` and most verbs start fast.
"""

import argparse
from typing import TYPE_CHECKING

from grader.common.errors import CourseError

if TYPE_CHECKING:
    from grader.course import Course

NO_DATE = 'none'
"""Given instead of a date, it removes a due date."""


def run_release(course: 'Course', asked: argparse.Namespace) -> int:
    """Update notebooks/, and print the files that have changed."""
    from grader.authoring.release import release
    from grader.storage.database import has_database
    from grader.storage.registering import register

    wanted = [asked.assignment] if asked.assignment else course.assignments()
    if has_database(course):
        for assignment in wanted:
            register(course, assignment)  # raises if graded submissions would not fit any more
    changed = release(
        course, asked.assignment or '*', fresh_outputs=asked.fresh_outputs, say=print
    )
    for path in changed:
        print(f'notebooks/{path}')
    print(f'{len(changed)} files changed.' if changed else 'Nothing has changed.')
    return 0


def run_bundle(course: 'Course', asked: argparse.Namespace) -> int:
    """Make the students' zip, and print what it leaves out."""
    from grader.authoring.bundle import bundle

    made = bundle(course, asked.file)
    for path in made.left_out:
        print(f'left out: {path}')
    print(f'{asked.file}: {len(made.files)} files, {made.bytes / 1e6:.1f} MB')
    return 0


def run_translate(course: 'Course', asked: argparse.Namespace) -> int:
    """Update locale/ from the English texts, and list what is to be translated."""
    from grader.authoring import translate

    for line in translate.report_lines(translate.update_catalogues(course)):
        print(line)
    return 0


def run_collect(course: 'Course', asked: argparse.Namespace) -> int:
    """Take in submissions, a line for each file; return 1 if none was taken or one was left."""
    from grader.collect.collect import LEFT, collect
    from grader.collect.collect_table import table_lines

    rows = list(collect(course, asked.source, file_times=asked.file_times))
    for line in table_lines(rows, asked.source):
        print(line)
    taken = any(row.student_id and row.outcome != LEFT for row in rows)
    if taken:
        print('Next: ./course grade')
    return 0 if taken and not any(row.outcome == LEFT for row in rows) else 1


def run_due(course: 'Course', asked: argparse.Namespace) -> int:
    """Set a due date or an extension if one is given, and list all of them."""
    from grader.storage.deadlines import extended_for_nobody
    from grader.storage.due_dates import (
        describe_deadlines,
        describe_early_solutions,
        set_due,
    )

    if asked.student and not asked.assignment:
        raise CourseError(
            '--student extends the date of one assignment: ./course due ASSIGNMENT DATE '
            f'--student {asked.student}. ./course due, alone, lists all dates and extensions'
        )
    if asked.assignment:
        if asked.when is None:
            raise CourseError(
                f'say until when: ./course due {asked.assignment} 2026-11-30, or none for no date'
            )
        when = None if asked.when == NO_DATE else asked.when
        set_due(course, asked.assignment, when, student_id=asked.student)
    for line in (
        *describe_deadlines(course),
        *extended_for_nobody(course),
        *describe_early_solutions(course),
    ):
        print(line)
    # each of these verbs applies the new date, without running any submission again
    if asked.assignment and any(course.folder('submitted', '', '').glob(f'*/{asked.assignment}')):
        print('Next: ./course scores, ./course feedback or ./course grade: each counts it')
    return 0


def try_sandbox_early(asked: argparse.Namespace) -> None:
    """Begin to try the sandbox in a thread: it mostly waits, and imports go on meanwhile."""
    from grader.kernels.isolation import try_in_background

    if not asked.dask:
        try_in_background()


def run_grade(course: 'Course', asked: argparse.Namespace) -> int:
    """Grade, with a row for each submission, or grade again with a seed and compare."""
    from grader.cli import begin_grade

    return begin_grade.start_workers_and_grade(course, asked)


def run_serve(course: 'Course', asked: argparse.Namespace) -> int:
    """Serve a folder until it is ended, or print the state of the process that does."""
    from grader.cli import serve_verb

    return serve_verb.run_serve(course, asked)


def run_scores(course: 'Course', asked: argparse.Namespace) -> int:
    """Write a table of scores, and print its path."""
    from grader.cli import hand_back

    return hand_back.run_scores(course, asked)


def run_solutions(course: 'Course', asked: argparse.Namespace) -> int:
    """Write notebooks with the answers, to hand out after the deadline."""
    from grader.export.sample_solutions import write_solutions

    wanted = [asked.assignment] if asked.assignment else ()
    written = write_solutions(course, wanted, early=asked.early)
    for path in written.paths:
        print(path)
    if written.left_out:
        print('Not written, because students may still submit:')
        print(*(f'  {line}' for line in written.left_out), sep='\n')
        if written.early:
            print(written.early)
        print('Next, when they are closed: ./course solutions. With --early, all are written now.')
    return 0


def run_feedback(course: 'Course', asked: argparse.Namespace) -> int:
    """Write the feedback pages, and print where they are."""
    from grader.cli import hand_back

    return hand_back.run_feedback(course, asked)


def run_demo(course: 'Course', asked: argparse.Namespace) -> int:
    """Grade the sample class; return 1 if an outcome is not as the name says."""
    from grader.cli.demo import demo

    return 0 if demo(root=course.root) else 1


def run_doctor(course: 'Course', asked: argparse.Namespace) -> int:
    """Print what isolates student code on this machine."""
    from grader.cli import doctor_verb

    return doctor_verb.run_doctor(course, asked)
