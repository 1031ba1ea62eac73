"""Take in an entry of the inbound folder: copy its files, add a row for each submission."""

import os
import shutil
import tempfile
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path

from grader.collect.collect import store_submission
from grader.collect.incoming import Incoming
from grader.collect.matching import MatchedFile, match
from grader.collect.platform_ids import StudentNumbers
from grader.collect.submission_folders import writer
from grader.collect.uploads import read_inbound_entry
from grader.common.text import shorten, storable
from grader.course import Course
from grader.notebook.submission import LEFT_OUT, SECRET
from grader.serving.inbound import Entry
from grader.serving.queue import KEEPING, REFUSED, UNDECIDED, WAITING, Arrival, Queue
from grader.storage.lock import gradebook_lock
from grader.storage.records import records
from grader.storage.submitted import known_students

FOLDER = 'arrived'
MOST_WAITING = 50
"""For one student: each takes space on the disk, and only the newest of a lesson is graded."""
MOST_KEPT, MOST_KEPT_BYTES = 1_000, 1_000_000_000
"""For one student and lesson, including earlier ones that were replaced: a program that hands
in all night must not fill the disk, which everybody's work is on."""
MAX_REASON = 500


def take_in(course: Course, queue: Queue, inbound: Path, entry: Entry) -> list[Arrival]:
    """Copy an entry's submissions to gradebook/arrived/, record and return them."""
    shelf = course.gradebook / FOLDER
    shelf.mkdir(parents=True, exist_ok=True)
    waiting = queue.find(WAITING, KEEPING)
    with tempfile.TemporaryDirectory(prefix='.new-', dir=shelf) as aside:
        packages = {name: course.packages(name) for name in course.assignments()}
        asked_for = {each for several in packages.values() for each in several}
        found = list(read_inbound_entry(inbound, entry.name, Path(aside), asked_for))
        hand_ins, rest = match(
            [each for each in found if not each.is_litter],
            packages,
            packages=packages,
            students={*known_students(course), *(each.student_id for each in waiting)},
            is_all=False,
        )
        with gradebook_lock(course.gradebook):
            problems = StudentNumbers(course).check_and_store(hand_ins)
        reasons = [
            each.reason for each in rest if each.needs_attention and _is_work(each.incoming)
        ]
        rows = []
        for each, problem in zip(hand_ins, problems, strict=True):
            problem = problem or _no_room_reason(course, each, waiting)
            if problem:
                reasons.append(problem)
            else:
                folder = _copy_to(each, shelf)
                whose = (each.student_id, each.assignment)
                rows.append(_arrival(entry, WAITING, *whose, folder=folder))
                waiting.append(rows[-1])
        if reasons:
            more = f' (and {len(reasons) - 1} more)' if len(reasons) > 1 else ''
            reason = shorten(storable(reasons[0]), MAX_REASON) + more
            rows.append(_arrival(entry, REFUSED, reason=reason))
        return queue.add(entry.key, entry.fingerprint, rows)


def refuse(queue: Queue, entry: Entry, reason: str) -> list[Arrival]:
    """Record that an entry is left to a person, and why; return that row."""
    row = _arrival(entry, REFUSED, reason=shorten(storable(reason), MAX_REASON))
    return queue.add(entry.key, entry.fingerprint, [row])


def put_in_place(course: Course, arrival: Arrival) -> tuple[str, str]:
    """Put a submission where it is graded, as collect does; return the outcome and its reason."""
    folder = course.gradebook / FOLDER / arrival.folder
    hand_in = _hand_in(folder, arrival)
    with gradebook_lock(course.gradebook):
        return store_submission(
            course, hand_in, lambda: records(course, only={arrival.submission_key})
        )


def secret_of(course: Course, arrival: Arrival) -> str:
    """Return nbgrader's secret of a submission; '' if it has none."""
    path = course.gradebook / FOLDER / arrival.folder / SECRET
    return path.read_bytes().decode(errors='replace') if path.is_file() else ''


def remove_copies(course: Course, arrivals: Iterable[Arrival]) -> None:
    """Remove the copies of submissions that are now in gradebook/submitted/ or kept elsewhere."""
    for each in arrivals:
        if each.folder:
            shutil.rmtree(course.gradebook / FOLDER / each.folder, ignore_errors=True)


def remove_unrecorded_copies(course: Course, queue: Queue) -> None:
    """Remove copies without a row: the process was ended before it recorded them."""
    known = {each.folder for each in queue.find(WAITING, KEEPING, UNDECIDED)}
    for left in (course.gradebook / FOLDER).glob('*'):
        if left.name not in known:
            shutil.rmtree(left)


def _hand_in(folder: Path, arrival: Arrival) -> MatchedFile:
    name = f'{arrival.assignment}.ipynb'
    secret, left_out = folder / SECRET, folder / LEFT_OUT
    ours = {folder / name, secret, left_out}
    files = sorted(path for path in folder.rglob('*') if path.is_file() and path not in ours)
    return MatchedFile(
        arrival.student_id,
        arrival.assignment,
        Incoming((arrival.entry, name), folder / name),
        {path.relative_to(folder).as_posix(): path for path in files},
        datetime.fromtimestamp(arrival.arrived, UTC),
        secret=secret if secret.is_file() else None,
        left_out=tuple(left_out.read_text('utf-8').splitlines()) if left_out.is_file() else (),
    )


def _no_room_reason(course: Course, each: MatchedFile, waiting: Sequence[Arrival]) -> str:
    """Return why a student's submission can't be taken in now; '' if there is room for it."""
    theirs = [other for other in waiting if other.student_id == each.student_id]
    if sum(other.state == WAITING for other in theirs) >= MOST_WAITING:
        return f'{MOST_WAITING} submissions of {each.student_id} wait'
    earlier = course.folder('submitted_before', each.student_id, each.assignment)
    same_lesson = [other.folder for other in theirs if other.assignment == each.assignment]
    waits = [course.gradebook / FOLDER / folder for folder in same_lesson]
    kept = len(waits) + sum(1 for _ in earlier.glob('*'))
    size = sum(map(_size_of, (earlier, *waits)))
    if kept < MOST_KEPT and size < MOST_KEPT_BYTES:
        return ''
    return (
        f'{kept:,} submissions for {each.assignment} of {each.student_id} are kept, in '
        f'{size / 1e6:,.0f} MB: remove those that nobody needs from '
        f'{earlier.relative_to(course.gradebook.parent)}, and this one may be handed in again'
    )


def _size_of(folder: Path) -> int:
    inside = (Path(above, name) for above, _, names in os.walk(folder) for name in names)
    return sum(path.lstat().st_size for path in inside)


def _copy_to(each: MatchedFile, shelf: Path) -> str:
    """Copy a submission to a new folder and flush it to the disk; return the folder's name."""
    folder = Path(tempfile.mkdtemp(prefix='', dir=shelf))
    files = {f'{each.assignment}.ipynb': each.notebook.readable, **each.extra}
    writer(files, None, secret=each.secret, left_out=each.left_out)(folder)
    for path in (*folder.rglob('*'), folder, shelf):
        _sync(path)
    return folder.name


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _arrival(
    entry: Entry,
    state: str,
    student_id: str = '',
    assignment: str = '',
    *,
    folder: str = '',
    reason: str = '',
) -> Arrival:
    at = entry.changed.timestamp()
    return Arrival(0, entry.key, at, state, student_id, assignment, folder, reason)


def _is_work(incoming: Incoming) -> bool:
    """Whether a person should look at a file: not if it is a .txt, such as timestamp.txt."""
    return not incoming.parts[-1].endswith('.txt')
