"""The state of the resident process: lines for a terminal, and a self-contained HTML page."""

import fcntl
import time
from collections.abc import Iterator, Mapping
from datetime import datetime
from html import escape
from pathlib import Path

from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.common.text import printable, visible
from grader.course import Course
from grader.serving.queue import (
    FAILED,
    GRADED,
    GRADING,
    REFUSED,
    UNDECIDED,
    WAITING,
    Arrival,
    Queue,
)
from grader.serving.serve import LOCK
from grader.serving.turns import reason_to_wait
from grader.storage.deadlines import Deadlines, deadlines

PAGE = 'serve_status.html'
SHOWN = 20
"""How many rows of a state are listed; the others are only counted."""
FOR_A_PERSON = REFUSED, FAILED
"""States of which a terminal lists all rows, so that none is hidden by many others."""
LAST = 200
"""The number of latest gradings from which the usual time to feedback is computed."""
_BEING_GRADED = 'Being graded'
_ENDED = 'Not graded to the end: the next ./course serve grades it'
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>./course serve</title>
<meta http-equiv="refresh" content="5"><meta name="color-scheme" content="light dark">
<meta name="viewport" content="width=device-width">
<style>body {{ font: 1rem/1.5 system-ui, sans-serif; margin: 2rem; max-width: 60rem }}
li {{ overflow-wrap: anywhere }}</style></head>
<body><h1>./course serve</h1>{body}</body></html>
"""


def sections(
    course: Course, queue: Queue, now: float, *, shows_all: bool
) -> Iterator[tuple[str, list[str]]]:
    """Yield headings, each with a line for every submission below it.

    If `shows_all`, submissions that wait for a person are listed completely; otherwise a line says
    where they are listed.
    """
    try:
        rules = (deadlines(course.gradebook) or Deadlines()).resubmissions
    except CourseError as error:
        rules = Deadlines().resubmissions
        yield 'Paused: nothing is graded until this is corrected', [str(error)]
    starts = queue.starts()
    done = queue.find(GRADED, last=LAST)
    failed = [each for each in queue.find(FAILED) if not _is_graded_since(course, each)]
    counts = {**queue.counts(), FAILED: len(failed)}
    yield _summary(done, counts), []
    for state, heading in (
        (GRADING, _BEING_GRADED),
        (WAITING, 'Waiting'),
        (REFUSED, 'Not taken: a person should look'),
        (FAILED, 'Not graded, or not to the end: ./course grade tries again'),
        (UNDECIDED, 'A check could not decide: graded once more when there is time'),
        (GRADED, 'Graded last'),
    ):
        is_whole = shows_all and state in FOR_A_PERSON
        if state == FAILED:
            found = failed if is_whole else failed[-SHOWN:]
        else:
            found = queue.find(state, last=None if is_whole else SHOWN)
        more, lines = counts.get(state, 0) - len(found), []
        if more > 0 and state in FOR_A_PERSON:
            lines.append(f'{more:,} more before these: ./course serve --status')
        for each in found:
            started = starts.get(each.submission_key, ())
            waits = reason_to_wait(started, rules, now) * (state == WAITING)
            lines.append(_line(each, waits))
        if found:
            yield heading, lines


def status_lines(course: Course, queue: Queue | None) -> Iterator[str]:
    """Yield the lines of `./course serve --status`."""
    runs = _is_served(course)
    if runs:
        yield './course serve runs.'
    else:
        yield './course serve does not run: ./course serve FOLDER grades what has come in since.'
    for heading, lines in sections(course, queue, time.time(), shows_all=True) if queue else ():
        yield _ENDED if heading == _BEING_GRADED and not runs else heading
        yield from (f'  {printable(line)}' for line in lines)


def write_status_page(course: Course, queue: Queue) -> Path:
    """Write the status page into the gradebook; return its path."""
    parts = [f'<p>As of {_clock(time.time())}</p>']
    for heading, lines in sections(course, queue, time.time(), shows_all=False):
        items = ''.join(f'<li>{escape(visible(line))}</li>' for line in lines)
        parts.append(f'<h2>{escape(heading)}</h2><ul>{items}</ul>' if lines else f'<p>{heading}')
    path = course.gradebook / PAGE
    write_whole(path, _PAGE.format(body=''.join(parts)))
    return path


def _summary(done: list[Arrival], counts: Mapping[str, int]) -> str:
    said = ', '.join(f'{number} {state}' for state, number in sorted(counts.items()) if number)
    if not done:
        return f'{said or "Nothing has come in"}.'
    seconds = sorted(each.ended - each.arrived for each in done)
    half, most = (seconds[min(len(seconds) - 1, int(p * len(seconds)))] for p in (0.5, 0.95))
    return (
        f'{said}. From arrival to feedback, for the last {len(done)}: '
        f'half within {half:.1f} s, 95 % within {most:.1f} s.'
    )


def _is_graded_since(course: Course, each: Arrival) -> bool:
    """Whether ./course grade has graded and decided a submission that this process could not."""
    graded = course.folder('autograded', *each.submission_key) / f'{each.assignment}.ipynb'
    try:
        return graded.stat().st_mtime > each.ended and '"ungraded"' not in graded.read_text()
    except OSError:
        return False


def _line(each: Arrival, waits: str) -> str:
    what = f'{each.assignment} of {each.student_id}' if each.student_id else each.entry
    score = f', {each.score:g} of {each.max_score:g}' if each.score is not None else ''
    why = waits or each.reason
    return f'{_clock(each.arrived)}  {what}{score}' + (f': {why}' if why else '')


def _clock(at: float) -> str:
    return f'{datetime.fromtimestamp(at).astimezone():%Y-%m-%d %H:%M:%S}'


def _is_served(course: Course) -> bool:
    """Whether a process holds the lock; a file that is open only to read answers that, too."""
    try:
        lock = (course.gradebook / LOCK).open('rb')
    except FileNotFoundError:
        return False
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
