"""What there is to translate: each English text of the course, in parts, with where it stands."""

from collections.abc import Iterator
from pathlib import Path

from grader.authoring import index
from grader.authoring.blocks import translatable, translatable_html, without_mark_scheme
from grader.authoring.editions import is_translated
from grader.course import Course

Texts = dict[str, list[str]]
"""Where each English text of a part stands, in the order in which they are read."""

STUDENTS = 'students.md'
"""In solutions/: the README of what students get."""


def parts_of(course: Course) -> dict[str, Texts]:
    """Return the English texts of each part: the lessons and the pages beside them."""
    parts = {name: _lesson(course, name) for name in course.assignments()}
    parts[index.PART] = {text: [index.INDEX] for text in _index(course)}
    for page in (*index.copied_pages(course), STUDENTS):
        path = course.root / 'solutions' / page
        if path.is_file():
            blocks = translatable(path.read_text(encoding='utf-8'))
            parts[Path(page).stem] = {block: [page] for block in blocks}
    return parts


def _lesson(course: Course, name: str) -> Texts:
    texts: Texts = {}
    for cell in course.source(name).cells:
        if is_translated(cell):
            for block in translatable(without_mark_scheme(cell.source)):
                texts.setdefault(block, []).append(cell.id)
    for page in sorted(course.source_path(name).parent.glob('*.html')):
        for text in translatable_html(page.read_text(encoding='utf-8')):
            texts.setdefault(text, []).append(page.name)
    return texts


def _index(course: Course) -> Iterator[str]:
    for text in index.TEXTS:
        yield from translatable(text)
