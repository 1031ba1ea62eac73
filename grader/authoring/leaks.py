"""Find answers and hidden tests in files that students get."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import nbformat
from my_robot_basics.validate.lessons.cells import is_code
from my_robot_basics.validate.lessons.exercises import find_exercises
from nbformat import NotebookNode

from grader.course import Course

BROKEN = '### BROKEN: '
"""The prefix of a line of code that is released broken, for students to fix (see release.py)."""
MARKS = (
    *('BEGIN SOLUTION', 'END SOLUTION', 'BEGIN HIDDEN TESTS', 'END HIDDEN TESTS'),
    *('BEGIN MARK SCHEME', 'END MARK SCHEME'),
    BROKEN.strip(),
)
COMMON_PHRASE = 25
"""Lines that are not longer than this, such as `for _ in range(3):`, occur in any program."""


def leaks_of(course: Course, assignment: str, released: Path) -> Iterator[str]:
    """Yield a message for each answer and hidden test in an assignment's released files."""
    secret = _secrets(course.source(assignment))
    for path in files_in(released / assignment):
        file = released / assignment / path
        text = _text(file.name, file.read_bytes())
        for mark in MARKS:
            if mark in text:
                yield f'{assignment}/{path} has a line with {mark!r}'
        for line in sorted(secret):
            if line in text:
                yield f'{assignment}/{path} shows a line of an answer or a hidden test: {line!r}'


def leaks_beside(course: Course, files: Mapping[str, bytes]) -> Iterator[str]:
    """Yield a message for what other files reveal to students: programs, texts, indexes.

    A program may have one line in common with an answer by accident, but not two of one
    assignment, and not a line of a hidden test that is longer than COMMON_PHRASE. A catalogue
    repeats texts of programs: a line that a program has is ignored in it.
    """
    programs = '\n'.join(_text(name, files[name]) for name in files if name.endswith('.py'))
    for assignment in course.assignments():
        source = course.source(assignment)
        secret = _secrets(source)
        tests = {line for cell in source.cells if _is_check(cell) for line in _secret_lines(cell)}
        for name, content in files.items():
            text = _text(name, content)
            said = programs if name.endswith('.po') else ''
            found = sorted(line for line in secret if line in text and line not in said)
            revealing = [line for line in found if line in tests and len(line) > COMMON_PHRASE]
            for line in revealing or found[1:]:
                yield f'{name} shows a line of an answer or a hidden test: {line!r}'
    for name, content in files.items():
        for mark in MARKS:
            if mark in _text(name, content):
                yield f'{name} has a line with {mark!r}'


def files_in(folder: Path) -> list[Path]:
    """Return the files in `folder`, relative to it, sorted, without hidden files of editors."""
    found = (path.relative_to(folder) for path in folder.rglob('*') if path.is_file())
    return sorted(p for p in found if not any(part.startswith('.') for part in p.parts))


def _secrets(notebook: NotebookNode) -> set[str]:
    """Return the lines that must not be released, except those that a lesson shows openly."""
    cells = notebook.cells
    tries = {
        index
        for exercise in find_exercises(notebook)
        for index in range(exercise.answer + 1, max(exercise.grades, default=0))
        if is_code(cells[index]) and 'nbgrader' not in cells[index].metadata
    }
    """Cells to experiment in: a longer line that their author has left there is not taught."""
    secret = {line for cell in cells for line in _secret_lines(cell)}
    taught = {line for i, cell in enumerate(cells) if i not in tries for line in _open_lines(cell)}
    return {line for line in secret if not any(line in open_line for open_line in taught)}


def _is_check(cell: NotebookNode) -> bool:
    marks = cell.metadata.get('nbgrader', {})
    return bool(marks.get('grade') and not marks.get('solution'))


def _secret_lines(cell: NotebookNode) -> Iterator[str]:
    """Yield the lines that must not be released, stripped."""
    lines = list(_marked_lines(cell))
    marks = cell.metadata.get('nbgrader', {})
    all_of_it = marks.get('solution') and not any(hidden for _, hidden in lines)
    yield from _revealing(line for line, hidden in lines if hidden or all_of_it)


def _open_lines(cell: NotebookNode) -> Iterator[str]:
    """Yield the lines that students may read, stripped."""
    if not set(_secret_lines(cell)) or any(hidden for _, hidden in _marked_lines(cell)):
        yield from _revealing(line for line, hidden in _marked_lines(cell) if not hidden)


def _marked_lines(cell: NotebookNode) -> Iterator[tuple[str, bool]]:
    """Yield each line of a cell, and whether it is in a marked region."""
    hidden = False
    for line in cell.source.splitlines():
        if BROKEN in line:
            yield line.replace(BROKEN, ''), False
        elif any(mark in line for mark in MARKS):
            hidden = 'BEGIN' in line
        else:
            yield line, hidden


def _revealing(lines: Iterable[str]) -> Iterator[str]:
    """Yield the stripped lines that reveal something; a bracket or a single word does not."""
    yield from (s for line in lines if len(s := line.strip()) > 5 and ' ' in s)


def _text(name: str, content: bytes) -> str:
    """Return all text in a file; for a notebook, with outputs and metadata."""
    if not name.endswith('.ipynb'):
        return content.decode(errors='replace')
    return '\n'.join(_strings(nbformat.reads(content.decode(), as_version=4)))


def _strings(value: object) -> Iterator[str]:
    if isinstance(value, dict):
        value = value.values()
    if isinstance(value, str):
        yield value
    elif isinstance(value, Iterable):
        for item in value:
            yield from _strings(item)
