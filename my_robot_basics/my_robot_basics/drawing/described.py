"""Pictures that come with their words. Imports nothing that is slow."""

import base64
import html
from typing import Any

Bundle = dict[str, Any]
"""MIME types and their data."""


def described(png: bytes, text: str) -> tuple[Bundle, dict[str, Any]]:
    """A picture and its alternative text as a notebook's output: the data, and its metadata.

    JupyterLab shows the HTML, since it leaves the words out of a plain PNG; others take the PNG.
    """
    words = text.replace('\n', '; ')
    source = base64.b64encode(png).decode('ascii')
    image = f'<img alt="{html.escape(words)}" src="data:image/png;base64,{source}">'
    bundle = {'image/png': png, 'text/html': image, 'text/plain': text}
    return bundle, {'image/png': {'alt': words}}
