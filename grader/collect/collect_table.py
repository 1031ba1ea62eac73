"""Format what `./course collect` has taken, and what it has not, as lines of text."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path

from grader.collect.collect import AGAIN, EARLIER, KNOWN, LEFT, NEW, UNUSED, FileOutcome
from grader.collect.name_forms import shared_folders
from grader.common.text import columns, pad, printable, shorten

WORDS = {NEW: 'new', AGAIN: 'handed in again', EARLIER: 'an earlier one', KNOWN: 'there already'}
SHOWN = 3
"""If more files of a folder have the same reason, only their number is shown."""
MOST_OF_ONE = 12
"""The most lines about one folder: a student can cause as many reasons as files."""
MAX_COLUMNS = 120
"""The most columns of a path: it can have 5,000 characters, and widens all lines of a table."""


def table_lines(rows: Iterable[FileOutcome], source: Path) -> Iterator[str]:
    """Yield the lines of the report: what was taken, what was not and why, and how many."""
    rows = list(rows)
    if not rows:
        yield (
            f'Nothing was taken: there is no file in {printable(str(source))}. Expected what '
            'students handed in: name another folder or archive, or download it again'
        )
        return
    taken = [row for row in rows if row.student_id and row.outcome != LEFT]
    parts = [[*_table(('student', 'assignment', 'handed in (UTC)', ''), map(_taken, taken))]]
    left = [(row.path, row.reason) for row in rows if row.outcome == LEFT]
    if left:
        table = _table(('file', 'reason'), _few_alike(left))
        parts.append(['Not taken; they stay where they are:', *table])
    if unused := list(_gathered([row for row in rows if row.outcome == UNUSED])):
        parts.append(['Not used for grading:', *_table(('file', 'reason'), unused)])
    count = Counter(row.outcome for row in rows)
    said = [f'{count[outcome]} {words}' for outcome, words in WORDS.items() if count[outcome]]
    parts.append([f'{", ".join(said) or "Nothing was taken"}; {len(left)} not taken.'])
    for number, part in enumerate(filter(None, parts)):
        yield from ([''] if number else [])
        yield from part


def _taken(row: FileOutcome) -> tuple[str, ...]:
    time = f'{row.handed_in:%Y-%m-%d %H:%M:%S}' if row.handed_in else '–'
    what = f'{WORDS[row.outcome]}: {row.reason}' if row.reason else WORDS[row.outcome]
    return row.student_id, row.assignment, time, what


def _gathered(rows: list[FileOutcome]) -> Iterator[tuple[str, str]]:
    """Yield paths and reasons; files with the same reason in one top folder are counted."""
    alike = defaultdict(list)
    for row in rows:
        alike[row.path.split('/')[0] if '/' in row.path else '', row.reason].append(row.path)
    for (_, reason), paths in alike.items():
        if len(paths) > SHOWN:
            yield f'{paths[0]} and {len(paths) - 1} more', reason
        else:
            yield from ((path, reason) for path in paths)


def _few_alike(left: list[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """Yield paths and reasons; many alike in a folder are shown as the first few and a number."""
    parts = [path.split('/') for path, _ in left]
    shared = len(shared_folders([tuple(each[:-1]) for each in parts]))
    folders: dict[str, dict[str, list]] = defaultdict(lambda: defaultdict(list))
    for (path, reason), each in zip(left, parts, strict=True):
        folders['/'.join(each[: shared + 1])][reason.partition(':')[0]].append((path, reason))
    for folder, kinds in folders.items():
        lines = 0
        for kind, files in list(kinds.items()):
            if lines >= MOST_OF_ONE:
                break
            del kinds[kind]
            few = files if len(files) <= SHOWN + 1 else files[:SHOWN]
            yield from few
            if more := len(files) - len(few):
                yield f'… and {more:,} more like it', kind
            lines += len(few) + bool(more)
        if more := sum(map(len, kinds.values())):
            yield f'… and {more:,} more in {folder}', 'for other reasons'


def _table(titles: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    shown = ((shorten(printable(first), MAX_COLUMNS), *map(printable, r)) for first, *r in rows)
    table = [titles, *shown]
    widths = [max(columns(row[i]) for row in table) for i in range(len(titles) - 1)]
    if len(table) > 1:
        for row in table:
            padded = [pad(field, width) for field, width in zip(row, [*widths, 0], strict=True)]
            yield '  '.join(padded).rstrip()
