"""Spell out in HTML what hides text, whether it stands there as a character or as an entity."""

import re
from html import escape, unescape

from my_robot_basics.validate.text import visible

_ENTITY = re.compile(r'&(#\d+|#x[0-9a-f]+|\w+);?', re.IGNORECASE)


def spell_out(html: str) -> str:
    """Replace invisible characters and marks of direction in HTML by escape sequences."""
    return visible(_ENTITY.sub(lambda entity: _spelled(entity[0]), html))


def _spelled(entity: str) -> str:
    meant = unescape(entity)
    return entity if visible(meant) == meant else escape(visible(meant))
