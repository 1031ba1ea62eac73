"""Put into lines what `./course collect` has taken, and what it has not."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator

from grader.collect import AGAIN, EARLIER, KNOWN, LEFT, NEW, UNUSED, Row
from grader.text import columns, pad, printable

WORDS = {NEW: 'new', AGAIN: 'handed in again', EARLIER: 'an earlier one', KNOWN: 'there already'}
SHOWN = 3
"""Files of one folder that nobody grades are counted once they are more."""


def lines(rows: Iterable[Row]) -> Iterator[str]:
    """Yield the lines of the report: what was taken, what was not and why, and how many."""
    rows = list(rows)
    taken = [row for row in rows if row.student_id and row.outcome != LEFT]
    yield from _table(('student', 'assignment', 'handed in (UTC)', ''), map(_taken, taken))
    left = [(row.path, row.reason) for row in rows if row.outcome == LEFT]
    if left:
        yield from ('', 'Not taken; they stay where they are:')
        yield from _table(('file', 'reason'), left)
    if unused := list(_gathered([row for row in rows if row.outcome == UNUSED])):
        yield from ('', 'Not used for grading:')
        yield from _table(('file', 'reason'), unused)
    count = Counter(row.outcome for row in rows)
    parts = [f'{count[outcome]} {words}' for outcome, words in WORDS.items() if count[outcome]]
    nothing = 'Nothing was taken' if rows else 'Nothing was taken, for there is no file in it'
    yield from ('', f'{", ".join(parts) or nothing}; {len(left)} not taken.')


def _taken(row: Row) -> tuple[str, ...]:
    time = f'{row.handed_in:%Y-%m-%d %H:%M:%S}' if row.handed_in else '–'
    what = f'{WORDS[row.outcome]}: {row.reason}' if row.reason else WORDS[row.outcome]
    return row.student_id, row.assignment, time, what


def _gathered(rows: list[Row]) -> Iterator[tuple[str, str]]:
    """Yield files and reasons; many of one kind in one place are counted."""
    alike = defaultdict(list)
    for row in rows:
        alike[row.path.split('/')[0] if '/' in row.path else '', row.reason].append(row.path)
    for (_, reason), paths in alike.items():
        if len(paths) > SHOWN:
            yield f'{paths[0]} and {len(paths) - 1} more', reason
        else:
            yield from ((path, reason) for path in paths)


def _table(titles: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    table = [titles, *(tuple(printable(field) for field in row) for row in rows)]
    widths = [max(columns(row[i]) for row in table) for i in range(len(titles) - 1)]
    if len(table) > 1:
        for row in table:
            padded = [pad(field, width) for field, width in zip(row, [*widths, 0], strict=True)]
            yield '  '.join(padded).rstrip()
