"""Write the editions: the English release, translated into each other language."""

import shutil
from collections.abc import Callable, Iterable
from pathlib import Path

import nbformat

from grader.authoring.blocks import translatable_blocks, translatable_html, translate_html
from grader.authoring.editions import Edition, editions, is_translated
from grader.authoring.index import write_pages
from grader.common.files import write_whole
from grader.course import Course


def write_editions(
    course: Course,
    names: Iterable[str],
    built: Path,
    *,
    metadata: dict,
    say: Callable[[str], None] = lambda line: None,
) -> None:
    """Write these lessons, and the pages, into a folder of `built` for each language.

    `metadata` is that of the contents page. `say` gets a line for each lesson that is not
    completely translated.
    """
    for edition in editions(course):
        _write_lessons(edition, names, built, say)
        folder = built / edition.language
        folder.mkdir(exist_ok=True)
        write_pages(course, folder, metadata=metadata, edition=edition)


def _write_lessons(
    edition: Edition,
    names: Iterable[str],
    built: Path,
    say: Callable[[str], None],
) -> None:
    """Write these lessons, translated from the built English ones, into an edition's folder."""
    for name in names:
        folder = built / edition.language / name
        shutil.copytree(built / name, folder)
        english = nbformat.read(built / name / f'{name}.ipynb', as_version=4)
        translated = edition.notebook(name, english)
        write_whole(folder / f'{name}.ipynb', nbformat.writes(translated) + '\n')
        blocks = [
            b for c in english.cells if is_translated(c) for b in translatable_blocks(c.source)
        ]
        for page in sorted(folder.glob('*.html')):
            text = page.read_text(encoding='utf-8')
            blocks += translatable_html(text)
            translated_page = translate_html(text, edition.translations(name), edition.language)
            write_whole(page, translated_page)
        if missing := [block for block in blocks if block not in edition.translations(name)]:
            say(
                f'{edition.language}: {len(missing)} of {len(blocks)} blocks of {name} are in'
                ' English: ./course translate lists them'
            )
