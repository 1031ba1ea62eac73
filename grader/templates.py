"""Jinja templates of the pages that the grader writes: whatever they are given is escaped."""

from collections.abc import Callable, Mapping
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, Template


def template(
    name: str,
    *,
    filters: Mapping[str, Callable] | None = None,
    values: Mapping[str, object] | None = None,
) -> Template:
    """Load the template `name` beside this file, with filters and values of its own."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= filters or {}
    environment.globals |= values or {}
    return environment.get_template(name)
