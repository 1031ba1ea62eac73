"""Split a text into the blocks that are translated one by one: paragraphs, lists, table rows.

A block is the text between blank lines, except in fenced code. Each row of a table is a block, so
that a change of one row does not affect the others.
"""

import re
from collections.abc import Iterator, Mapping

FENCE = re.compile(r' {0,3}(```|~~~)')
_MARK_SCHEME = re.compile(r'### BEGIN MARK SCHEME\n.*?### END MARK SCHEME', re.DOTALL)
_NO_WORDS = re.compile(
    r'```.*?```|~~~.*?~~~|`[^`]*`|<code>.*?</code>|\$[^$]*\$|\]\([^)]*\)|<[^>]*>|&\w+;', re.DOTALL
)
_WORD = re.compile(r'[^\W\d_]{2,}')


def split_blocks(text: str) -> list[str]:
    """Return gaps and blocks alternately, beginning with a gap; joined, they are the text.

    Every second item, from the second on, is a block.
    """
    pieces = ['']
    is_block = False
    for line, kind in _lines(text):
        begins_anew = kind == 'row' or (kind == 'block' and pieces[-1].startswith('|'))
        if (kind != 'gap') != is_block or (is_block and begins_anew):
            if is_block and kind != 'gap':
                pieces.append('')  # the gap between two rows, which gets the line end
            pieces.append('')
            is_block = kind != 'gap'
        pieces[-1] += line
    return list(_with_line_ends_between(pieces))


def _lines(text: str) -> Iterator[tuple[str, str]]:
    """Yield each line with its kind: 'block', 'row' of a table, or 'gap'."""
    fenced = False
    for line in text.splitlines(keepends=True):
        if FENCE.match(line):
            fenced = not fenced
            yield line, 'block'
        elif fenced or line.strip():
            yield line, 'row' if not fenced and line.startswith('|') else 'block'
        else:
            yield line, 'gap'


def _with_line_ends_between(pieces: list[str]) -> Iterator[str]:
    """Yield the pieces, with the last line ends of each block moved to the piece after it."""
    moved = ''
    for index, piece in enumerate(pieces):
        if index % 2 == 0:
            yield moved + piece
            moved = ''
        else:
            kept = piece.rstrip('\n')
            moved = piece[len(kept) :]
            yield kept
    if moved:
        yield moved


def has_words(block: str) -> bool:
    """Whether a block has words to translate; code, formulas and addresses do not count."""
    return bool(_WORD.search(_NO_WORDS.sub(' ', block)))


_ELEMENT = re.compile(r'<(h[1-6]|p|td|th|li|title|caption)\b[^>]*>(.+?)(?=</\1>)')
"""An element of an HTML page within one line; its second group is its text."""
_LANGUAGE = re.compile(r'(<html lang=)"[^"]*"')


def translatable_html(page: str) -> list[str]:
    """Return the texts of an HTML page's elements, in order."""
    return [text for _, text in _ELEMENT.findall(page) if has_words(text)]


def translate_html(page: str, translations: Mapping[str, str], language: str) -> str:
    """Return an HTML page with each text replaced by its translation, if there is one."""
    code = language.replace('_', '-')
    page = _LANGUAGE.sub(rf'\1"{code}"', page)
    return _ELEMENT.sub(
        lambda found: found[0].removesuffix(found[2]) + translations.get(found[2], found[2]),
        page,
    )


def without_mark_scheme(text: str) -> str:
    """Return a text without the mark schemes, which only instructors read."""
    return _MARK_SCHEME.sub('', text)


def translatable_blocks(text: str) -> list[str]:
    """Return the blocks of a text that have words, in order."""
    return [block for block in split_blocks(text)[1::2] if has_words(block)]


def translate_blocks(text: str, translations: Mapping[str, str]) -> str:
    """Return a text with each block replaced by its translation, if there is one."""
    pieces = split_blocks(text)
    pieces[1::2] = [translations.get(block, block) for block in pieces[1::2]]
    return ''.join(pieces)
