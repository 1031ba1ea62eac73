"""Split a text into the blocks that are translated one by one: paragraphs, lists, table rows.

A block is what stands between blank lines, outside of fenced code; each row of a table is one of
its own, so that a change of one row leaves the others as they are.
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
    """Return, alternately, what is between the blocks and the blocks; joined they are the text.

    Every second item, from the second on, is a block.
    """
    pieces = ['']
    is_block = False
    for line, kind in _lines(text):
        begins_anew = kind == 'row' or (kind == 'block' and pieces[-1].startswith('|'))
        if (kind != 'gap') != is_block or (is_block and begins_anew):
            if is_block and kind != 'gap':
                pieces.append('')  # nothing but the end of a line lies between two rows
            pieces.append('')
            is_block = kind != 'gap'
        pieces[-1] += line
    return list(_with_line_ends_between(pieces))


def _lines(text: str) -> Iterator[tuple[str, str]]:
    """Yield each line with what it is: 'block', 'row' of a table, or 'gap'."""
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
    """Yield the pieces, the last line end of each block moved to what follows it."""
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
    """Whether a block says something to translate: code, formulas and addresses do not."""
    return bool(_WORD.search(_NO_WORDS.sub(' ', block)))


_ELEMENT = re.compile(r'<(h[1-6]|p|td|th|li|title|caption)\b[^>]*>(.+?)(?=</\1>)')
"""An element of a page that stands in one line; its second group is what it says."""
_LANGUAGE = re.compile(r'(<html lang=)"[^"]*"')


def translatable_html(page: str) -> list[str]:
    """Return what the elements of an HTML page say, in order."""
    return [text for _, text in _ELEMENT.findall(page) if has_words(text)]


def translate_html(page: str, translations: Mapping[str, str], language: str) -> str:
    """Return an HTML page with each text that has one replaced by its translation."""
    code = language.replace('_', '-')
    page = _LANGUAGE.sub(rf'\1"{code}"', page)
    return _ELEMENT.sub(
        lambda found: found[0].removesuffix(found[2]) + translations.get(found[2], found[2]),
        page,
    )


def without_mark_scheme(text: str) -> str:
    """Return a text without what only instructors read of it."""
    return _MARK_SCHEME.sub('', text)


def translatable(text: str) -> list[str]:
    """Return the blocks of a text that say something, in order."""
    return [block for block in split_blocks(text)[1::2] if has_words(block)]


def translate_blocks(text: str, translations: Mapping[str, str]) -> str:
    """Return a text with each block that has one replaced by its translation."""
    pieces = split_blocks(text)
    pieces[1::2] = [translations.get(block, block) for block in pieces[1::2]]
    return ''.join(pieces)
