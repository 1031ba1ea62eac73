"""Filters for nbgrader's formgrader, so that a submission can't run code, load files or hang it.

The formgrader's template omits nbconvert's `sanitize_html` for markdown cells, and it renders in
the server's own process. So what students wrote is turned into HTML in a process with limits.
"""

import re
from collections.abc import Iterator
from functools import lru_cache
from html import unescape

import bleach
from bleach.html5lib_shim import Filter
from jinja2 import pass_context
from jinja2.runtime import Context
from markupsafe import Markup
from my_robot_basics.validate.kernels.pictures import KINDS
from nbconvert import HTMLExporter
from nbconvert import filters as nbconvert_filters

from grader.common.parsing import Limits, ParsingFailed, parse
from grader.common.text import visible
from grader.report.hidden_characters import spell_out

LIMITS = Limits(cpu_sec=5)
"""For one cell or one output; an ordinary one takes some milliseconds of CPU time."""
FILTERS = {
    'markdown2html': 'grader.report.formgrader.harmless_markdown',
    'highlight_code': 'grader.report.formgrader.highlight_code',
    'clean_html': 'grader.report.formgrader.clean_html',
    'ansi2html': 'grader.report.formgrader.visible_output',
    'strip_files_prefix': 'grader.report.formgrader.without_files_prefix',
}
"""They replace filters of nbconvert's HTMLExporter."""
OUTPUT_KINDS = [*KINDS, 'text/plain']
"""What is shown of an output, as on the page of feedback: HTML and formulas may have links."""
_TAGS = {'p', 'em', 'strong', 'del', 'code', 'pre', 'ul', 'ol', 'li', 'blockquote', 'br', 'hr'}
_TAGS |= {'table', 'thead', 'tbody', 'tr', 'th', 'td'}
_TAGS |= {'h1', 'h2', 'h3', 'h4', 'h5', 'h6', 'a', 'img', 'span', 'div'}
_LINKS_IN_FORMULAS = re.compile(r'\\(href|mmlToken|enclose)')
"""TeX with which MathJax, which typesets the formgrader's pages, makes links."""
_PASTED = ('data:image/png;base64,', 'data:image/jpeg;base64,')


class _AddressesAsText(Filter):
    """Shows the address of a link behind its text: nobody follows it by a click.

    It may lead to the server of that student, which on a hub has the address of the formgrader:
    such a page can do all that the person who opens it may do.
    """

    def __iter__(self) -> Iterator[dict]:
        addresses = []
        for token in super().__iter__():
            if token['type'] == 'StartTag' and token['name'] == 'a':
                addresses.append(token['data'].pop((None, 'href'), ''))
            elif token['type'] == 'EndTag' and token['name'] == 'a' and (to := addresses.pop()):
                yield {'type': 'Characters', 'data': f' ({unescape(to)})'}
            yield token


def _allowed(tag: str, name: str, value: str) -> bool:
    """Whether a tag may have an attribute; bleach itself checks the protocol of links."""
    if tag == 'img':
        return name == 'alt' or (name == 'src' and value.startswith(_PASTED))
    return tag == 'a' and name == 'href'


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
    return Markup(_render_in_process('grader.report.formgrader:render_html', text))


def visible_output(text: str) -> Markup:
    """Show the colours of an output's text: a Jinja filter that replaces nbconvert's ansi2html."""
    return Markup(visible(nbconvert_filters.ansi2html(text)))


def without_files_prefix(html: str) -> Markup:
    """Do what nbconvert's strip_files_prefix does: a Jinja filter."""
    if 'files/' not in html:
        return Markup(html)
    return Markup(_render_in_process('nbconvert.filters:strip_files_prefix', str(html)))


def render_markdown(text: str, attachments: dict) -> str:
    """Return markdown as HTML with harmless tags only."""
    html = HTMLExporter().markdown2html({'cell': {'attachments': attachments}}, text)
    cleaner = bleach.Cleaner(
        tags=_TAGS,
        attributes=_allowed,
        protocols={'http', 'https', 'mailto', 'data'},
        filters=[_AddressesAsText],
    )
    html = spell_out(cleaner.clean(html))
    # MathJax leaves an element of this class as it is
    return f'<div class="tex2jax_ignore">{html}</div>' if _has_linked_formula(html) else html


def _has_linked_formula(html: str) -> bool:
    return _LINKS_IN_FORMULAS.search(unescape(html)) is not None


def render_code(source: str) -> str:
    """Return highlighted Python code, as HTML."""
    return spell_out(nbconvert_filters.Highlight2HTML()(source))


def render_html(html: str) -> str:
    """Return the harmless part of HTML that an output has."""
    return spell_out(nbconvert_filters.clean_html(html))


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
