"""Remove spaces between Chinese words and names, and English articles before names."""

import re

QUOTED = re.compile(r'`[^`]*`|\'[^\']*\'|"[^"]*"')
_HAN = '[\u3400-\u9fff（），。；：]'
_IN_HAN = re.compile(rf'({QUOTED.pattern})|(?<={_HAN}) (?={_HAN})')
"""A space between Chinese characters; or quoted text, which is kept."""
_ARTICLE = re.compile(
    rf'({QUOTED.pattern})|(?:(?<={_HAN})|(?<={_HAN} ))an? (?=[A-Za-z])|^an? (?=\w+(?: \(|$))'
)
"""An English article after Chinese words, or before a single word; or quoted text, kept."""


def remove_spaces(text: str) -> str:
    """Remove spaces between Chinese words, and the article of a name, such as 'an int'.

    Quoted text stays as it is.
    """
    named = _ARTICLE.sub(lambda found: found[1] or '', text)
    return _IN_HAN.sub(lambda found: found[1] or '', named)
