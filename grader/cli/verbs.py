"""What `./course VERB` does and prints: a function for each verb, which returns the status.

Each imports what it needs: `--help` and a wrong argument need none of it, and most verbs little.
"""

import argparse
from typing import TYPE_CHECKING

from grader.common.errors import CourseError

if TYPE_CHECKING:
    from grader.course import Course

NO_DATE = 'none'
"""Stands for a due date that is taken back."""


def run_release(course: 'Course', asked: argparse.Namespace) -> int:
    """Write notebooks/ anew, and name the files that have changed."""
    from grader.authoring.release import release
    from grader.storage.database import has_database
    from grader.storage.registering import register

    wanted = [asked.assignment] if asked.assignment else course.assignments()
    if has_database(course):
        for assignment in wanted:
            register(course, assignment)  # refuses what graded submissions can't follow
    changed = release(
        course, asked.assignment or '*', fresh_outputs=asked.fresh_outputs, say=print
    )
    for path in changed:
        print(f'notebooks/{path}')
    print(f'{len(changed)} files changed.' if changed else 'Nothing has changed.')
    return 0


def run_bundle(course: 'Course', asked: argparse.Namespace) -> int:
    """Make the zip that students get, and say what it leaves out."""
    from grader.authoring.bundle import bundle

    made = bundle(course, asked.file)
    for path in made.left_out:
        print(f'left out: {path}')
    print(f'{asked.file}: {len(made.files)} files, {made.bytes / 1e6:.1f} MB')
    return 0


def run_translate(course: 'Course', asked: argparse.Namespace) -> int:
    """Bring locale/ up to date with the English texts, and list what is to be translated."""
    from grader.authoring import translate

    for line in translate.lines(translate.update(course)):
        print(line)
    return 0


def run_collect(course: 'Course', asked: argparse.Namespace) -> int:
    """Take in submissions, a line for each file. 1 where none was taken or one wants a look."""
    from grader.collect.collect import LEFT, collect
    from grader.collect.collect_table import lines

    rows = list(collect(course, asked.source, file_times=asked.file_times))
    for line in lines(rows, asked.source):
        print(line)
    taken = any(row.student_id for row in rows)
    if taken:
        print('Next: ./course grade')
    return 0 if taken and not any(row.outcome == LEFT for row in rows) else 1


def run_due(course: 'Course', asked: argparse.Namespace) -> int:
    """Set a due date or an extension where one is given, and list all of them."""
    from grader.storage.deadlines import extended_for_nobody
    from grader.storage.due_dates import describe_deadlines, set_due

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
    for line in (*describe_deadlines(course), *extended_for_nobody(course)):
        print(line)
    # what a date changes is counted by each of them, without running anything again
    if asked.assignment and any(course.folder('submitted', '', '').glob(f'*/{asked.assignment}')):
        print('Next: ./course scores, ./course feedback or ./course grade: each counts it')
    return 0


def begin_grade(asked: argparse.Namespace) -> None:
    """Begin to try the sandbox: programs are waited for, and so much can be imported meanwhile."""
    from grader.kernels.isolation import look_ahead

    if not asked.dask:
        look_ahead()


def run_grade(course: 'Course', asked: argparse.Namespace) -> int:
    """Grade, a row for each submission, or grade once more and compare."""
    from grader.cli import begin_grade

    return begin_grade.run_grade(course, asked)


def run_serve(course: 'Course', asked: argparse.Namespace) -> int:
    """Serve a folder until it is ended, or say what the process that does it is at."""
    from grader.cli import serve_verb

    return serve_verb.run_serve(course, asked)


def run_scores(course: 'Course', asked: argparse.Namespace) -> int:
    """Write a table of scores, and say where it lies."""
    from grader.cli import hand_back

    return hand_back.run_scores(course, asked)


def run_solutions(course: 'Course', asked: argparse.Namespace) -> int:
    """Write notebooks with the answers, to give out after the deadline."""
    from grader.export.sample_solutions import write_solutions

    wanted = [asked.assignment] if asked.assignment else ()
    for path in write_solutions(course, wanted, early=asked.early):
        print(path)
    return 0


def run_feedback(course: 'Course', asked: argparse.Namespace) -> int:
    """Write the pages of feedback, and say where they lie."""
    from grader.cli import hand_back

    return hand_back.run_feedback(course, asked)


def run_demo(course: 'Course', asked: argparse.Namespace) -> int:
    """Grade the sample class. 1 where a notebook does not come out as it is named."""
    from grader.cli.demo import demo

    return 0 if demo(root=course.root) else 1


def run_doctor(course: 'Course', asked: argparse.Namespace) -> int:
    """Print what isolates student code on this machine."""
    from grader.cli import doctor_verb

    return doctor_verb.run_doctor(course, asked)
