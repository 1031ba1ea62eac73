"""Print a row for each submission when it is graded, and a progress bar on a terminal."""

import shutil
import sys
import threading
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

from tqdm import tqdm

from grader.common.text import columns, pad, printable, shorten
from grader.grading import SubmissionOutcome
from grader.storage.submitted import SubmissionFolder

MAX_NAME_COLUMNS = 40
TICK_SEC = 1.0
_OUTCOMES = ('with all points', 'with fewer', 'for a person', 'not graded')


def print_rows(
    rows: Iterable[SubmissionOutcome],
    submissions: Sequence[SubmissionFolder],
    *,
    expected: dict[str, str] | None = None,
) -> Iterator[SubmissionOutcome]:
    """Print each row as it arrives, and yield it.

    `expected` adds a column: the expected outcome, by student.
    """
    student = _widest('student', (found.student_id for found in submissions))
    assignment = _widest('assignment', (found.assignment for found in submissions))
    extra = _widest('expected', expected.values()) if expected else 0

    def line(*fields: str) -> str:
        widths = (student, assignment, *([extra] if expected else []), 9)
        padded = [pad(shorten(field, w), w) for field, w in zip(fields[:-1], widths, strict=True)]
        return _fit('  '.join([*padded, fields[-1]]).rstrip())

    more = ['expected'] if expected else []
    print(line('student', 'assignment', *more, 'score', 'reason'), flush=True)
    bar = tqdm(rows, total=len(submissions), disable=None, leave=False, unit='notebook')
    outcomes: Counter[str] = Counter()
    by_submission: dict[tuple[str, str], str] = {}
    with bar, _ticking(bar):
        for row in bar:
            whose = row.student_id, row.assignment
            outcomes[by_submission.get(whose, '')] -= 1  # a second row replaces the first
            by_submission[whose] = _outcome(row)
            outcomes[by_submission[whose]] += 1
            counted = (f'{outcomes[said]} {said}' for said in _OUTCOMES if outcomes[said])
            bar.set_postfix_str(', '.join(counted), refresh=False)
            more = [expected.get(row.student_id, '')] if expected else []
            text = line(
                printable(row.student_id),
                printable(row.assignment),
                *more,
                score_of(row),
                reason_in_a_line(row),
            )
            tqdm.write(text)
            sys.stdout.flush()
            yield row


@contextmanager
def _ticking(bar: tqdm) -> Iterator[None]:
    """Redraw a bar each second: during a slow submission no rows arrive, but its clock goes on."""
    done = threading.Event()

    def draw() -> None:
        while not done.wait(TICK_SEC):
            bar.refresh()

    if bar.disable:  # stdout is not a terminal
        yield
        return
    thread = threading.Thread(target=draw, name='bar', daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _outcome(row: SubmissionOutcome) -> str:
    if row.stored is None:
        return 'not graded'
    if row.stored.pending:
        return 'for a person'
    return 'with all points' if row.stored.score >= row.stored.max_score else 'with fewer'


def score_of(row: SubmissionOutcome) -> str:
    """Return a row's score as text: '2/5', or '2/5 …' if a part waits for manual grading."""
    if row.stored is None:
        return '–'
    waits = ' …' if row.stored.pending else ''
    return f'{row.stored.score:g}/{row.stored.max_score:g}{waits}'


def reason_in_a_line(row: SubmissionOutcome) -> str:
    """Return the reason of a row as one line, with what has changed, or that nothing has."""
    stored, text = row.stored, printable(row.reason)
    if stored and stored.pending and not text:
        text = 'the rest is graded by hand'
    if stored and stored.late:
        text = f'(late: -{stored.late:g}) {text}'
    if stored and stored.former is not None and stored.former != stored.score:
        text = f'(was {stored.former:g}) {text}'
    elif row.reused:
        text = f'(unchanged) {text}'
    return f'(graded again) {text}' if row.again else text


def changes(rows: Iterable[SubmissionOutcome]) -> list[str]:
    """Return a line for each score that differs from the earlier one."""
    return [
        f'{printable(row.student_id)}  {printable(row.assignment)}  '
        f'{row.stored.former:g} → {row.stored.score:g} '
        f'({row.stored.score - row.stored.former:+g})'
        for row in rows
        if row.stored and row.stored.former not in (None, row.stored.score)
    ]


def _widest(title: str, names: Iterable[str]) -> int:
    return min(MAX_NAME_COLUMNS, max(columns(printable(name)) for name in (title, *names)))


def _fit(line: str) -> str:
    """Cut a line to the terminal's width; keep all of it if stdout is not a terminal."""
    return shorten(line, shutil.get_terminal_size().columns) if sys.stdout.isatty() else line
