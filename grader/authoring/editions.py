"""The editions of the course: the same release in another language, in notebooks/LANGUAGE/.

Only what people read is translated, block by block, and the course's own sentences in outputs.
Code, ids and metadata are those of the English release, so an answer from any edition is graded
with the same source. A block without a translation stays English.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import nbformat
from babel.messages.pofile import PoFileError
from my_robot_basics.language.catalogues import (
    ENGLISH,
    catalogue_path,
    languages,
    read_translations,
)
from my_robot_basics.language.speaking import LANGUAGE
from my_robot_basics.validate.lessons.cells import KEY, role
from nbformat import NotebookNode

from grader.authoring.blocks import translate_blocks
from grader.authoring.edition_outputs import OutputWords
from grader.common.errors import CourseError
from grader.course import Course


@dataclass(frozen=True)
class Edition:
    """A language of the course, with its translations."""

    language: str = ENGLISH
    locale: Path | None = None
    """The folder of the catalogues; None for English."""
    _parts: dict[str, dict[str, str]] = field(default_factory=dict, compare=False)

    def translations(self, part: str) -> Mapping[str, str]:
        """Return the translated blocks of a lesson or a page, by their English text.

        Raises CourseError if the catalogue is damaged.
        """
        if self.locale is None:
            return {}
        if part not in self._parts:
            try:
                self._parts[part] = read_translations(self.locale, self.language, part)
            except (PoFileError, UnicodeDecodeError) as error:
                path = catalogue_path(self.locale, self.language, part)
                raise CourseError(f'{path} cannot be read: {error}') from None
        return self._parts[part]

    def text(self, part: str, english: str) -> str:
        """Return the text of a page, translated."""
        return translate_blocks(english, self.translations(part))

    def notebook(self, name: str, english: NotebookNode) -> NotebookNode:
        """Return a lesson, translated: its text cells, and the course's own words in outputs."""
        notebook = nbformat.from_dict(english)
        if self.locale is None:
            return notebook
        words = OutputWords(self.locale, self.language)
        for cell in notebook.cells:
            if is_translated(cell):
                cell.source = self.text(name, cell.source)
            for output in cell.get('outputs', []):
                words.translate(output)
        notebook.metadata.setdefault(KEY, NotebookNode())[LANGUAGE] = self.language
        return notebook


def editions(course: Course) -> list[Edition]:
    """Return the editions other than English, sorted by language."""
    locale = course.root / 'locale'
    return [Edition(language, locale) for language in languages(locale)]


def is_translated(cell: NotebookNode) -> bool:
    """Whether a cell is translated: a text of the lesson, not a student's text or its stub."""
    return cell.cell_type == 'markdown' and role(cell) == 'text'
