"""Render a graded notebook as one self-contained HTML page without scripts."""

import re
from contextlib import suppress
from functools import cache, partial

import bleach
import nbformat
from jinja2 import Template
from markupsafe import Markup, escape
from my_robot_basics.feedback.hidden import PLACE
from my_robot_basics.language.catalogues import ENGLISH, languages, read_translations
from my_robot_basics.language.speaking import LOCALE, in_language, language_of, sentences
from nbconvert.filters import markdown2html
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from grader.common.text import visible
from grader.kernels.isolation import NO_SANDBOX
from grader.notebook.restore import KEY, NO_ANSWERS
from grader.report.hidden_characters import spell_out
from grader.report.page_parts import find_sections
from grader.report.templates import put_markup, template

_TAGS = {'p', 'em', 'strong', 'code', 'pre', 'ul', 'ol', 'li', 'blockquote', 'h4', 'br', 'table'}
_TAGS |= {'thead', 'tbody', 'tr', 'th', 'td'}
_CODE = HtmlFormatter(style='xcode', nowrap=True)
_CODE_IN_THE_DARK = HtmlFormatter(style='github-dark', nowrap=True)
_FIRST_WORD = re.compile(r'\A(a|[a-z]{2,})(?=[ ,:;]|\Z)(?!.*[\u3400-\u9fff])', re.DOTALL)
"""An English word; one letter alone, as x, and a word that begins a Chinese text are names."""


def render_page(as_json: dict, about: dict, plain: str = '') -> str:
    """Return the page; `about` has nbgrader's student, assignment, score, max_score, late_penalty.

    Grade cells have only what students may see, and scores: see gather_verdicts.py. If `plain` is
    not empty, it says why text and code are shown unformatted. All arguments are JSON.
    """
    notebook = nbformat.from_dict(as_json)
    ours = notebook.metadata.get(KEY, {})
    problem = ours.get('problem', '')
    told = [note for note in (plain, *ours.get('notes', ())) if note not in ('', problem)]
    language = language_of(notebook.metadata)
    sections, others = find_sections(notebook, language)
    return _template(language, is_plain=bool(plain)).render(
        about=about,
        sections=[]
        if problem
        else [section for section in sections if section.checks or section.answer],
        checks=[check for section in sections for check in section.checks],
        others=others,
        problem=problem,
        title=_title(ours.get('title', ''), about, language),
        no_sandbox='' if ours.get('in_sandbox', True) else NO_SANDBOX,
        # it cost points, unlike what else was restored
        no_answers=NO_ANSWERS if NO_ANSWERS in told else '',
        notes=[note for note in told if note != NO_ANSWERS],
    )


def get_ready() -> None:
    """Prepare what all pages need: each page is made in a forked process, which inherits it."""
    _colour('None')
    _rich('None')
    _template(ENGLISH, is_plain=False)
    for language in languages(LOCALE):
        with suppress(Exception):  # a page in this language will raise the error
            _template(language, is_plain=False)


def _colour(source: str) -> Markup:
    return Markup(highlight(source, PythonLexer(), _CODE))


def _rich(text: str) -> Markup:
    """Turn markdown into HTML with harmless tags only."""
    html = bleach.clean(markdown2html(text), tags=_TAGS, attributes={}, strip=True)
    return Markup(spell_out(html))


def _words(text: str) -> Markup:
    """Show text between backticks as code."""
    return Markup(re.sub('`([^`]+)`', r'<code>\1</code>', str(escape(text))))


def capitalised(text: str) -> str:
    """Capitalise the first word, unless it is a name in the code."""
    return _FIRST_WORD.sub(lambda word: word[0].capitalize(), text)


def _number(value: float) -> str:
    return f'{value:g}'


def _typed(text: str) -> Markup:
    """Show text unformatted, with its line ends."""
    return Markup('<pre>{}</pre>').format(visible(text))


def _title(english: str, about: dict, language: str) -> str:
    """Return the lesson's title in the language of the page."""
    translations = (
        read_translations(LOCALE, language, str(about.get('assignment')))
        if language != ENGLISH
        else {}
    )
    return translations.get(f'# {english}', f'# {english}').removeprefix('# ')


@cache
def _template(language: str, *, is_plain: bool) -> Template:
    known = {} if language == ENGLISH else sentences(language).translations
    return template(
        'page.html.j2',
        filters={
            'colour': escape if is_plain else _colour,
            'rich': _typed if is_plain else _rich,
            'words': _words,
            'sentence': capitalised,
            'number': _number,
            'said': partial(in_language, language),
        },
        values={
            'at_grading': PLACE,
            '_': partial(put_markup, known),
            'language_code': language.replace('_', '-'),
            'code_style': Markup(_CODE.get_style_defs('pre')),
            'dark_code_style': Markup(_CODE_IN_THE_DARK.get_style_defs('pre')),
        },
    )
