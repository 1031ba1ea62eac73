"""Read translations from gettext's files, locale/LANGUAGE/LC_MESSAGES/PART.po.

A part is a lesson, another page, or a part of the software. A text whose translation is missing
or fuzzy stays English.
"""

from pathlib import Path

LOCALE = Path(__file__).resolve().parents[3] / 'locale'
"""The folder of the catalogues, beside the package in the course and in a student's bundle."""
ENGLISH = 'en'
"""The language of the source: it needs no catalogue."""
MESSAGES = 'LC_MESSAGES'
"""gettext's name for the folder of a language's catalogues."""


def languages(locale: Path) -> list[str]:
    """Return the languages that have a folder with catalogues in `locale`, sorted: ['zh_CN']."""
    return sorted(folder.parent.name for folder in locale.glob(f'*/{MESSAGES}') if folder.is_dir())


def catalogue_path(locale: Path, language: str, part: str) -> Path:
    """Return the path of the catalogue of a part."""
    return locale / language / MESSAGES / f'{part}.po'


def read_translations(locale: Path, language: str, part: str) -> dict[str, str]:
    """Return the translation of each English text of a part; {} if there is no catalogue.

    Raises babel.messages.pofile.PoFileError if the file is damaged.
    """
    path = catalogue_path(locale, language, part)
    if not path.is_file():
        return {}
    from babel.messages.pofile import read_po  # takes 50 ms, which English readers need not wait

    with path.open('rb') as file:
        catalogue = read_po(file, locale=language, abort_invalid=True)
    return {
        message.id: message.string
        for message in catalogue
        if isinstance(message.id, str)
        and isinstance(message.string, str)
        and message.id
        and message.string
        and not message.fuzzy
    }
