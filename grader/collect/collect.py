"""Take in what students handed in: match it to students, copy it to where it is graded.

Nothing is overwritten. The submission that counts is in gradebook/submitted/STUDENT/ASSIGNMENT/.
What it replaced is in gradebook/submitted_before/STUDENT/ASSIGNMENT/NUMBER/, with its grade.
"""

import shutil
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from pathlib import Path

from grader.collect.matching import MatchedFile, match
from grader.collect.platform_ids import StudentNumbers
from grader.collect.submission_folders import (
    contents,
    contents_of_earlier,
    digests,
    put_atomically,
    put_numbered,
    timestamp,
    within,
    writer,
)
from grader.collect.uploads import read_upload
from grader.common.dates import date_of, utc_of
from grader.common.errors import DISK_FULL, CourseError, TaskFailed
from grader.common.files import write_whole
from grader.course import Course
from grader.export.scores import as_csv
from grader.notebook.submission import TIMESTAMP
from grader.storage.database import has_database
from grader.storage.lock import gradebook_lock
from grader.storage.records import CellScore, records
from grader.storage.submitted import known_students

NEW, AGAIN, EARLIER, KNOWN = 'new', 'again', 'earlier', 'known'
"""Outcomes of a submission: the first one, a later one, an earlier one, one already there."""
LEFT, UNUSED = 'left', 'unused'
"""Outcomes of a file that was not taken: a person should look at it, or it is not graded."""


@dataclass(frozen=True)
class FileOutcome:
    """What the run reports about one file."""

    path: str
    """Its path within what was collected."""
    outcome: str
    reason: str = ''
    student_id: str = ''
    assignment: str = ''
    handed_in: datetime | None = None


def collect(course: Course, source: Path, *, file_times: bool = False) -> Iterator[FileOutcome]:
    """Take in a folder, an archive or a notebook; yield an outcome for each file, untaken last.

    Only gradebook/ is written to; `source` is not changed. Collecting again changes nothing. If
    nothing else says when a file was handed in, `file_times` uses its modification time. Raises
    CourseError if `source` can't be collected, or if the disk is full.
    """
    refuse_the_course(course, source.resolve())
    grades = cache(lambda: records(course))
    with gradebook_lock(course.gradebook), tempfile.TemporaryDirectory(prefix='collect-') as aside:
        try:
            packages = {name: course.packages(name) for name in course.assignments()}
            asked_for = {each for several in packages.values() for each in several}
            found = list(read_upload(source, Path(aside), asked_for))
            visible = [each for each in found if not each.is_litter]
            hand_ins, rest = match(
                visible,
                packages,
                packages=packages,
                students=known_students(course),
                file_times=file_times,
            )
            problems = StudentNumbers(course).check_and_store(hand_ins)
            for each, problem in zip(hand_ins, problems, strict=True):
                yield _row(course, each, problem, grades)
        except OSError as error:
            if error.errno not in DISK_FULL:
                raise
            raise CourseError(
                'the disk is full: what was collected is kept whole; free some space, and collect '
                'the same again'
            ) from None
        for left in sorted(rest, key=lambda left: left.incoming.parts):
            yield FileOutcome(
                left.incoming.path, LEFT if left.needs_attention else UNUSED, left.reason
            )
        for incoming in found:
            if incoming.is_litter:
                yield FileOutcome(incoming.path, UNUSED, 'hidden, or left behind by a program')


def refuse_the_course(course: Course, source: Path) -> None:
    """Raise CourseError if `source` contains the lessons: `zh_CN` would become a student."""
    root = course.root.resolve()
    lessons = [root / name for name in ('notebooks', 'solutions')]
    if root.is_relative_to(source) or any(map(source.is_relative_to, lessons)):
        raise CourseError(
            f"{source} holds the course's own lessons: expected a folder with what students "
            'handed in, and nothing else'
        )


def _row(
    course: Course, each: MatchedFile, problem: str, grades: Callable[[], list[CellScore]]
) -> FileOutcome:
    try:
        outcome, reason = (LEFT, problem) if problem else store_submission(course, each, grades)
        if not problem and each.remark:
            reason = f'{reason}; {each.remark}' if reason else each.remark
    except OSError as error:
        if error.errno in DISK_FULL:
            raise
        outcome, reason = LEFT, f'{error.strerror}: {error.filename}'
    except TaskFailed as why:  # the folder of the earlier submission is too large
        outcome, reason = LEFT, str(why)
    whose = (each.student_id, each.assignment)
    return FileOutcome(each.notebook.path, outcome, reason, *whose, each.handed_in)


def store_submission(
    course: Course, each: MatchedFile, grades: Callable[[], list[CellScore]]
) -> tuple[str, str]:
    """Copy a submission to its folder in submitted/; return the outcome and its reason."""
    place = course.folder('submitted', each.student_id, each.assignment)
    shelf = course.folder('submitted_before', each.student_id, each.assignment)
    files = dict(_files(each))
    came = digests(files)
    if not place.exists():
        put_atomically(
            writer(files, each.handed_in, secret=each.secret, left_out=each.left_out), place
        )
        return NEW, ''
    there, when = contents(place), date_of(place / TIMESTAMP)
    if came == there:
        return KNOWN, _note_time(place / TIMESTAMP, each.handed_in, when)
    both = (each.handed_in, when) if each.handed_in and when else None
    if not (both and both[0] > both[1]) and came in contents_of_earlier(shelf):
        return KNOWN, (
            'the same as an earlier one, which a later one has replaced; if this one counts, '
            f'move {_path_in_messages(place, course)} away and collect it again'
        )
    if both and both[0] <= both[1]:
        kept = put_numbered(
            within(
                'submitted',
                writer(files, each.handed_in, secret=each.secret, left_out=each.left_out),
            ),
            shelf,
        )
        return EARLIER, f'a later one is there already; kept in {_path_in_messages(kept, course)}'
    if there not in contents_of_earlier(shelf):  # else a run was killed right after keeping it
        put_numbered(lambda folder: _copy_all(course, each, folder, grades), shelf)
    put_atomically(
        writer(files, each.handed_in, secret=each.secret, left_out=each.left_out), place
    )
    return AGAIN, f'the one before and its grade are kept in {_path_in_messages(shelf, course)}'


def _note_time(path: Path, came: datetime | None, stored: datetime | None) -> str:
    """Write when a submission was handed in if that was not known; return which time counts."""
    if stored and came != stored:
        return f'the time that counts is {stored:%Y-%m-%d %H:%M:%S}'
    if came is None or came == stored:
        return 'nothing new'
    taken = utc_of(path.parent.stat().st_mtime)
    if taken and came > taken:  # the same files once more, which must not make them late
        return f'taken in before that, on {taken:%Y-%m-%d %H:%M:%S}, without a time'
    write_whole(path, timestamp(came))
    return 'when it was handed in was not known before'


def _files(each: MatchedFile) -> Iterator[tuple[str, Path]]:
    yield f'{each.assignment}.ipynb', each.notebook.readable
    yield from each.extra.items()


def _copy_all(
    course: Course, each: MatchedFile, folder: Path, grades: Callable[[], list[CellScore]]
) -> None:
    """Copy all of a submission: its files, its graded notebook and feedback, and its scores."""
    for step in ('submitted', 'autograded', 'feedback'):
        there = course.folder(step, each.student_id, each.assignment)
        if there.is_dir():
            shutil.copytree(there, folder / step, symlinks=True)
    if not has_database(course):
        return
    whose = (each.student_id, each.assignment)
    theirs = [grade for grade in grades() if (grade.student_id, grade.assignment) == whose]
    write_whole(folder / 'scores.csv', as_csv(course, theirs))


def _path_in_messages(path: Path, course: Course) -> str:
    return str(path.relative_to(course.gradebook.parent))
