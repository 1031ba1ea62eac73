"""`./course translate`: update the catalogues from the English texts, and list what is left.

If a text has changed a little, its translation stays, marked *fuzzy*, with the former English:
the release shows the new English until a translator has checked it and removed the mark.
"""

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from babel.messages.catalog import Catalog, Message
from babel.messages.pofile import PoFileError, read_po, write_po
from my_robot_basics.language.catalogues import MESSAGES, catalogue_path, languages

from grader.authoring.translatable import Texts, parts_of
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course

_KEPT = re.compile(r'Language:|Plural-Forms|MIME-Version|Content-')
"""The header lines that are kept. Git has authors and dates."""


@dataclass(frozen=True)
class PartReport:
    """How far a part is translated into a language."""

    language: str
    part: str
    texts: int
    """How many texts there are in English."""
    missing: tuple[tuple[str, str], ...]
    """Place and English of each text without a translation."""
    outdated: tuple[tuple[str, str], ...]
    """The same for a text whose translation is of a former English, or marked fuzzy."""


def update_catalogues(course: Course) -> list[PartReport]:
    """Update the catalogues of each language from the English texts; return what is left to do.

    Translations stay; those whose English no longer exists are removed. Raises CourseError if a
    catalogue can't be read.
    """
    locale, reports = course.root / 'locale', []
    parts = parts_of(course)
    for language in languages(locale):
        for part, texts in parts.items():
            path = catalogue_path(locale, language, part)
            catalogue = _updated(path, language, texts)
            write_whole(path, _as_text(catalogue).encode())
            reports.append(_report(language, part, texts, catalogue))
    left = [path for path in sorted(locale.glob(f'*/{MESSAGES}/*.po')) if path.stem not in parts]
    if left:
        raise CourseError(
            '; '.join(f'{path} belongs to no lesson, page or program: remove it' for path in left)
        )
    return reports


def _updated(path: Path, language: str, texts: Texts) -> Catalog:
    template = Catalog(project='my_robot_basics', fuzzy=False)
    for text, places in texts.items():
        template.add(text, auto_comments=list(dict.fromkeys(places)))
    catalogue = _read(path, language)
    catalogue.update(template, update_creation_date=False)
    catalogue.obsolete.clear()
    for message in catalogue:
        if not message.fuzzy:  # a translator may have left the former English
            message.user_comments = [
                line for line in message.user_comments if not line.startswith('|')
            ]
    return catalogue


def _read(path: Path, language: str) -> Catalog:
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        return Catalog(locale=language, project='my_robot_basics', header_comment='#', fuzzy=False)
    try:
        with path.open('rb') as file:
            return read_po(file, locale=language, ignore_obsolete=True, abort_invalid=True)
    except (PoFileError, UnicodeDecodeError) as error:
        raise CourseError(f'{path} cannot be read: {error}') from None


def _as_text(catalogue: Catalog) -> str:
    written = io.BytesIO()
    write_po(written, catalogue, width=0, no_location=True, include_previous=True)
    head, gap, rest = written.getvalue().decode().partition('\n\n')
    kept = [line for line in head.splitlines() if line[:3] == 'msg' or _KEPT.match(line, 1)]
    return '\n'.join(kept) + gap + rest


def _report(language: str, part: str, texts: Texts, catalogue: Catalog) -> PartReport:
    left: dict[bool, list[tuple[str, str]]] = {True: [], False: []}
    for text, places in texts.items():
        message = catalogue[text]
        assert isinstance(message, Message)  # the update has just added it
        if not message.string or message.fuzzy:
            left[bool(message.string)].append((places[0], text))
    return PartReport(language, part, len(texts), tuple(left[False]), tuple(left[True]))


def report_lines(reports: list[PartReport], *, most: int = 10) -> Iterator[str]:
    """Yield the lines to print: one for each part, and the texts that are left, shortened."""
    if not reports:
        yield 'No other language: make a folder such as locale/zh_CN/LC_MESSAGES/'
    for report in reports:
        done = report.texts - len(report.missing) - len(report.outdated)
        yield f'{report.language}  {report.part}: {done} of {report.texts}'
        if done == 0:  # not begun yet: do not list every text
            folder = f'locale/{report.language}/{MESSAGES}'
            yield f'    not begun: fill the msgstr lines of {folder}/{report.part}.po'
            continue
        for word, left in (('out of date', report.outdated), ('missing', report.missing)):
            for place, text in left[:most]:
                yield f'    {word}: {place}: {" ".join(text.split()):.60}'
            if len(left) > most:
                yield f'    {word}: {len(left) - most} more'
