"""Jinja templates of the grader's pages: all values are escaped, and control characters shown."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, Template
from markupsafe import Markup, escape
from my_robot_basics.validate.text import visible


def template(
    name: str,
    *,
    filters: Mapping[str, Callable] | None = None,
    values: Mapping[str, object] | None = None,
) -> Template:
    """Load the template `name` from this folder, with additional filters and values."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_visible,
    )
    if os.access(compiled := Path(__file__).with_name('__pycache__'), os.W_OK):
        environment.bytecode_cache = FileSystemBytecodeCache(str(compiled))  # beside Python's
    environment.filters |= filters or {}
    environment.globals |= values or {}
    return environment.get_template(name)


def put_markup(translations: Mapping[str, str], english: str, **values: object) -> Markup:
    """Return the translation of a page's own text, with its placeholders filled in."""
    text = escape(translations.get(english, english))
    return Markup(text.format(**values)) if values else text


def _visible(value: object) -> object:
    """Escape invisible characters, in text and in HTML made from text."""
    if isinstance(value, Markup):
        return Markup(visible(value))
    return visible(value) if isinstance(value, str) else value
