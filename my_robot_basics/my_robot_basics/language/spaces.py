"""What stands between a translation's words and a name: no space in Chinese, and no article."""

import re

QUOTED = re.compile(r'`[^`]*`|\'[^\']*\'|"[^"]*"')
_HAN = '[\u3400-\u9fff（），。；：]'
_IN_HAN = re.compile(rf'({QUOTED.pattern})|(?<={_HAN}) (?={_HAN})')
"""A space between Chinese words, beside a place: there is none; and what is quoted."""
_ARTICLE = re.compile(rf'({QUOTED.pattern})|(?:(?<={_HAN})|(?<={_HAN} ))an? (?=[A-Za-z])')
"""An English article behind Chinese words; and what is quoted."""


def close_up(text: str) -> str:
    """Return a text without spaces between Chinese words, except in what is quoted.

    And without the article of a name, such as 'an int'.
    """
    named = _ARTICLE.sub(lambda found: found[1] or '', text)
    return _IN_HAN.sub(lambda found: found[1] or '', named)
