"""Filters for nbgrader's formgrader, so that a submission can't run code, load files or hang it.

The formgrader's template omits nbconvert's `sanitize_html` for markdown cells, and it renders in
the server's own process. So what students wrote is turned into HTML in a process with limits.
"""

import re
from functools import lru_cache
from html import unescape

import bleach
from jinja2 import pass_context
from jinja2.runtime import Context
from markupsafe import Markup
from nbconvert import HTMLExporter
from nbconvert import filters as nbconvert_filters

from grader.common.parsing import Limits, ParsingFailed, parse
from grader.common.text import visible

LIMITS = Limits(cpu_sec=5)
"""For one cell or one output; an ordinary one takes some milliseconds of CPU time."""
FILTERS = {
    'markdown2html': 'grader.report.formgrader.harmless_markdown',
    'highlight_code': 'grader.report.formgrader.highlight_code',
    'clean_html': 'grader.report.formgrader.clean_html',
    'strip_files_prefix': 'grader.report.formgrader.without_files_prefix',
}
"""They replace filters of nbconvert's HTMLExporter."""
_TAGS = {'p', 'em', 'strong', 'del', 'code', 'pre', 'ul', 'ol', 'li', 'blockquote', 'br', 'hr'}
_TAGS |= {'table', 'thead', 'tbody', 'tr', 'th', 'td'}
_TAGS |= {'h1', 'h2', 'h3', 'h4', 'h5', 'h6', 'a', 'img', 'span', 'div'}
_IGNORED = re.compile(r'[\0-\x20]')
"""Characters that browsers ignore at the beginning of an address, and some within it."""
_PASTED = ('data:image/png;base64,', 'data:image/jpeg;base64,')


def _allowed(tag: str, name: str, value: str) -> bool:
    """Whether a tag may have an attribute; bleach itself checks the protocol of links."""
    if tag == 'img':
        return name == 'alt' or (name == 'src' and value.startswith(_PASTED))
    address = _IGNORED.sub('', unescape(value)).lower()
    return tag == 'a' and name == 'href' and not address.startswith('data:')


@pass_context
def harmless_markdown(context: Context, text: str) -> Markup:
    """Turn markdown into HTML, keeping only harmless tags and pasted pictures: a Jinja filter."""
    attachments = context.get('cell', {}).get('attachments', {})
    return Markup(
        _render_in_process('grader.report.formgrader:render_markdown', text, attachments)
    )


def highlight_code(source: str, language: str | None = None, metadata: object = None) -> Markup:
    """Highlight code: a Jinja filter that replaces nbconvert's Highlight2HTML."""
    return Markup(_render_in_process('grader.report.formgrader:render_code', source))


def clean_html(html: str | bytes) -> Markup:
    """Keep only the harmless part of HTML: a Jinja filter that replaces nbconvert's clean_html."""
    text = html.decode(errors='replace') if isinstance(html, bytes) else str(html)
    return Markup(_render_in_process('nbconvert.filters:clean_html', text))


def without_files_prefix(html: str) -> Markup:
    """Do what nbconvert's strip_files_prefix does: a Jinja filter."""
    if 'files/' not in html:
        return Markup(html)
    return Markup(_render_in_process('nbconvert.filters:strip_files_prefix', str(html)))


def render_markdown(text: str, attachments: dict) -> str:
    """Return markdown as HTML with harmless tags only."""
    html = HTMLExporter().markdown2html({'cell': {'attachments': attachments}}, text)
    protocols = {'http', 'https', 'mailto', 'data'}
    return bleach.clean(html, tags=_TAGS, attributes=_allowed, protocols=protocols)


def render_code(source: str) -> str:
    """Return highlighted Python code, as HTML."""
    return nbconvert_filters.Highlight2HTML()(source)


def _render_in_process(function: str, text: str, *more: object) -> str:
    """Return HTML that is made in a process with limits; if that fails, the text itself."""
    return _parse_cached(function, text) if not more else _parse_limited(function, text, *more)


@lru_cache(maxsize=1_000)
def _parse_cached(function: str, text: str) -> str:
    """Cache results: all submissions have many cells in common."""
    return _parse_limited(function, text)


def _parse_limited(function: str, text: str, *more: object) -> str:
    try:
        return parse(function, text, *more, limits=LIMITS)
    except ParsingFailed as why:
        shown = Markup('<p><strong>Shown as it was typed: {}.</strong></p><pre>{}</pre>')
        return shown.format(f'{why}', visible(text))
