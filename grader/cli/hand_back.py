"""The work and output of `./course scores` and `./course feedback`."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from grader.common.db_url import is_in_postgresql
from grader.common.errors import CourseError, GradebookError
from grader.common.text import printable
from grader.course import Course
from grader.export.scores import write_scores
from grader.export.totals import write_totals
from grader.passback.write import write_feedback_archives, write_platform_scores
from grader.storage.database import has_database, open_database, wait_until_free
from grader.storage.failures import gone_message
from grader.storage.registering import withdrawn
from grader.storage.ungraded import changed_lessons, ungraded

MOST_NAMED = 10
"""How many submissions that are not graded yet are named."""


def run_scores(course: Course, asked: argparse.Namespace) -> int:
    """Write a table of scores, and print its path."""
    to_platform = asked.format or (asked.send and not asked.roster)
    if (asked.assignment or asked.roster) and not to_platform:
        raise CourseError(
            'an assignment and --roster are for what a platform imports: say which one, as in '
            './course scores --format moodle'
        )
    _wait_for_database(course)
    if asked.send:
        status = _send_scores(course, asked.assignment)
        _say_what_comes_first(course)
        return status
    if asked.format:
        paths = write_platform_scores(
            course, asked.format, asked.assignment, asked.roster, _say_line
        )
        _print_paths(paths)
    else:
        print(write_totals(course) if asked.totals else write_scores(course))
        _say_what_is_withdrawn(course)
    _say_what_comes_first(course)
    return 0


def _send_scores(course: Course, assignment: str) -> int:
    """Send changed scores; return 1 if the platform has not taken all of them."""
    from grader.passback.lti import send_scores  # optional, and takes half a second to import

    done = send_scores(course, assignment, _say_line)
    print(f'{done.sent} scores sent, {done.waiting} waiting')
    if done.waiting:
        print('Nothing is lost. To send them: ./course scores --send lti')
    return 1 if done.waiting else 0


def run_feedback(course: Course, asked: argparse.Namespace) -> int:
    """Write the feedback pages, and print where they are."""
    from grader.report.feedback import write_feedback  # imports nbconvert; scores don't need it

    _wait_for_database(course)
    pages = write_feedback(course, say=_say_line)
    print(f'{len(pages)} page{"s"[: len(pages) != 1]} in {course.folder("feedback", "", "")}')
    if asked.zip:
        _print_paths(write_feedback_archives(course, _say_line))
    _say_what_comes_first(course)
    return 0


def _say_what_is_withdrawn(course: Course) -> None:
    """Print lessons that are no longer in solutions/, but whose scores still count."""
    with open_database(course.db_url) as book:
        found = withdrawn(course, book)
    for name, number in sorted(found.items()):
        if number:
            print(
                f'{name} is in solutions/ no longer, and still counts, with the scores of '
                f'{number} student{"s"[: number != 1]}. To delete them: '
                f'.venv/bin/nbgrader db assignment remove {name} --force',
                file=sys.stderr,
            )


def _print_paths(paths: Sequence[Path]) -> None:
    for path in paths:
        print(path)
    if not paths:
        print('No file was written: there is nothing to put into one.', file=sys.stderr)


def _say_line(line: str) -> None:
    print(printable(line))


def _wait_for_database(course: Course) -> None:
    if has_database(course):
        wait_until_free(course)
    elif _is_graded(course) and not is_in_postgresql(course.db_url):
        raise GradebookError(gone_message(course))


def _is_graded(course: Course) -> bool:
    return any(course.folder('autograded', '', '').glob('*/*/*.ipynb'))


def _say_what_comes_first(course: Course) -> None:
    """Print what is to be graded first: without that, what is handed back is not up to date."""
    if not _is_graded(course):
        print('Nothing is graded yet. Next: ./course grade', file=sys.stderr)
        return
    if lessons := changed_lessons(course):
        print(
            f'Changed since submissions were graded: {", ".join(lessons)}. What was written has '
            'the earlier results. Next: ./course grade, then this again',
            file=sys.stderr,
        )
    if found := ungraded(course):
        named = [f'{each.student_id} {each.assignment}' for each in found[:MOST_NAMED]]
        if more := len(found) - len(named):
            named.append(f'{more} more')
        print(
            'New or changed, and not graded yet: '
            f'{printable(", ".join(named))}. What was written has an earlier result of these, or '
            'none. Next: ./course grade, then this again',
            file=sys.stderr,
        )
