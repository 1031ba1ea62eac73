"""Pictures together with their alternative text. Imports nothing that is slow."""

import base64
import html
from typing import Any

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.picture_words import join_alt_text_lines, translate_alt_text

Bundle = dict[str, Any]
"""MIME types and their data."""


def gettext_noop(text: str) -> str:
    """Return a part of an alternative text as it is, marked for `./course translate`."""
    return text


def png_output(png: bytes, text: str, language: str = ENGLISH) -> tuple[Bundle, dict[str, Any]]:
    """Return a picture and its alternative text as a notebook's output: data and metadata.

    The text is translated into the language if there is a translation. The HTML is for
    JupyterLab, which ignores the alternative text of a plain PNG; other front ends use the PNG.
    """
    text = translate_alt_text(language, text)
    words = join_alt_text_lines(language, text)
    source = base64.b64encode(png).decode('ascii')
    image = f'<img alt="{html.escape(words)}" src="data:image/png;base64,{source}">'
    bundle = {'image/png': png, 'text/html': image, 'text/plain': text}
    return bundle, {'image/png': {'alt': words}}
