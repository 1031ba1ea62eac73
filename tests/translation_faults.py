"""Check that a translation keeps code, numbers and links, and the typography of Chinese."""

import re
import unicodedata
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

_FENCED = re.compile(r'```.*?```', re.DOTALL)
_CODE = re.compile(r'`[^`]+`|<code>[^<]*</code>')
_KEPT: dict[str, re.Pattern[str]] = {
    'code': _CODE,
    'fenced code': _FENCED,
    'a formula': re.compile(r'\$[^$\n]+\$'),
    'where a link leads': re.compile(r'\]\(([^)]+)\)'),
    'an address': re.compile(r'https?://[^)\s]+'),
    'a heading': re.compile(r'^#+ ', re.MULTILINE),
    'items of a list': re.compile(r'^ *(?:-|\d+\.) ', re.MULTILINE),
    'columns of a table': re.compile(r'(?<!\\)\|'),
    'a tag': re.compile(r'</?[a-z][^>]*>'),
    'bold type': re.compile(r'\*\*'),
}
_PLACEHOLDER = re.compile(r'\{\w*\}')
_UNNAMED = re.compile(r'\{(value|verb)\d*\}')
_NAME = re.compile(r'\b[\w.]+\(|\b\w+\.\w[\w.]*|\{\w+\}|\w*_\w+|/[\w/]+')
"""Names in code, and placeholders."""
_NUMBER = re.compile(r'(?<![\w.])\d+(?:[.,]\d+)*(?![\w])')
_HAN = r'[\u3400-\u9fff\uf900-\ufaff]'
_UNSPACED = re.compile(rf'{_HAN}(?=[A-Za-z0-9`$])|(?<=[A-Za-z0-9`$%°])(?={_HAN})')
_LATIN_MARK = re.compile(rf'(?<={_HAN})[,;:!?()](?!\S*`)|(?<={_HAN})\.(?=\s|$)|[,;:!?](?={_HAN})')
_SPACED_MARK = re.compile(
    r'(?<![|\s]) (?=[，。；：！？、）》])|(?<=[，。；：！？、（《）》]) (?=[^|\s])'
)
_EMPHASISED = re.compile(r'\*[^*\n]+\*')
_RUN = re.compile(r'[A-Za-z][A-Za-z0-9_-]*(?: [A-Za-z0-9_-]+)+')
"""Several Latin words in a row."""
_LINK_END = re.compile(r'\]\([^)]*\)')
_ELSEWHERE = re.compile(r'\[[^\]]*\]\(https?:[^)]*\)')
"""A link to an English page keeps its English name."""


def faults_of(english: str, translated: str) -> Iterator[str]:
    """Yield what is wrong with a translated block: what is lost, or typeset wrongly."""
    for what, pattern in _KEPT.items():
        ours, theirs = _count(pattern, english), _count(pattern, translated)
        if ours != theirs:
            yield f'{what}: {_difference(ours, theirs)}'
    plain = [_CODE.sub('', _FENCED.sub('', text)) for text in (english, translated)]
    if lost := _count(_NUMBER, plain[0]) - _count(_NUMBER, plain[1]):
        yield f'numbers: {", ".join(lost)} lost'
    had, has = (set(_PLACEHOLDER.findall(text)) for text in plain)
    # a placeholder without a name, such as for the s of a plural, is not needed in every language
    gone = {place for place in had - has if not _UNNAMED.fullmatch(place)}
    if different := gone | (has - had):
        yield f'places: {", ".join(sorted(different))}'
    yield from _typography(translated)


def _typography(text: str) -> Iterator[str]:
    """Yield violations of Chinese typography; a text in Latin script has none of them."""
    text = _FENCED.sub('', text)
    shown = _LINK_END.sub(']', text)
    for what, pattern in (
        ('no space between Chinese and Latin', _UNSPACED),
        ('a Latin mark in Chinese', _LATIN_MARK),
        ('a space beside a Chinese mark', _SPACED_MARK),
    ):
        for found in pattern.finditer(shown):
            yield f'{what}: {_around(shown, found.start())}'
    yield from _not_emphasised(_CODE.sub(lambda code: '`' * len(code[0]), text))


def _not_emphasised(text: str) -> Iterator[str]:
    """Yield * and ** that markdown does not read as emphasis.

    Beside a punctuation mark, as in `**节点：**是`, they count only if the other side is a
    space or a mark; between Chinese words there are no spaces.
    """
    for stars, kind in ((r'\*\*', 'bold'), (r'(?<!\*)\*(?!\*)', 'italic')):
        for number, found in enumerate(re.finditer(stars, text)):
            before, after = text[: found.start()][-1:], text[found.end() :][:1]
            inner, outer = (after, before) if number % 2 == 0 else (before, after)
            if _is_mark(inner) and outer.strip() and not _is_mark(outer):
                yield f'not shown in {kind} type: {_around(text, found.start())}'


def _is_mark(character: str) -> bool:
    return bool(character) and unicodedata.category(character)[0] in 'PS'


def _around(text: str, at: int) -> str:
    return f'…{text[max(0, at - 8) : at + 8]}…'.replace('\n', ' ')


def read_glossary(path: Path) -> dict[str, list[str]]:
    """Return the allowed translations of each English term: a line is `term | one | another`.

    Lines that begin with # are comments for translators.
    """
    rows = [
        [each.strip() for each in line.split('|')]
        for line in path.read_text(encoding='utf-8').splitlines()
        if line.strip() and not line.startswith('#')
    ]
    return {term: allowed for term, *allowed in rows}


def unknown_terms(
    english: str, translated: str, glossary: Mapping[str, Sequence[str]]
) -> Iterator[str]:
    """Yield each term of the English block that is not translated as the glossary allows.

    What the translation keeps word for word, such as *Publisher count* or ros2 node list, is
    ignored.
    """
    for kept in (*_EMPHASISED.findall(english), *_RUN.findall(translated)):
        english = english.replace(kept, '') if kept in translated else english
    text = _CODE.sub('', _FENCED.sub('', _LINK_END.sub(']', _ELSEWHERE.sub('', english))))
    text = _NAME.sub('', text)
    for term, allowed in glossary.items():
        is_there = re.search(rf'\b{re.escape(term)}s?\b', text, re.IGNORECASE)
        if is_there and not any(word.lower() in translated.lower() for word in allowed):
            yield f'{term}: expected {" or ".join(allowed)}'


def _count(pattern: re.Pattern[str], text: str) -> Counter[str]:
    return Counter(pattern.findall(text))


def _difference(ours: Counter[str], theirs: Counter[str]) -> str:
    lost, new = ours - theirs, theirs - ours
    said = [
        f'{word} {", ".join(map(repr, some))}'
        for word, some in (('lost', lost), ('new', new))
        if some
    ]
    return '; '.join(said)
