"""Lay out a graded notebook as one HTML page that needs nothing else and runs nothing."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from html import unescape

import bleach
import nbformat
from jinja2 import Template
from markupsafe import Markup, escape
from my_robot_basics.validate.pictures import KINDS, why_not_shown
from my_robot_basics.validate.titles import title_of_check, title_of_failure
from nbconvert.filters import markdown2html, strip_ansi
from nbformat import NotebookNode
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from grader.common.text import visible
from grader.kernels.isolation import NO_SANDBOX
from grader.notebook.restore import KEY, grade_id, role
from grader.report.templates import template

MAX_TEXT_CHARACTERS = 5_000
"""What is shown of one output."""

_TAGS = {'p', 'em', 'strong', 'code', 'pre', 'ul', 'ol', 'li', 'blockquote', 'h4', 'br', 'table'}
_TAGS |= {'thead', 'tbody', 'tr', 'th', 'td'}
_CODE = HtmlFormatter(style='xcode', nowrap=True)
_CODE_IN_THE_DARK = HtmlFormatter(style='github-dark', nowrap=True)
_REASON = re.compile(r'expected (?P<expected>.+?), saw (?P<seen>.+): (?P<hint>.+)', re.DOTALL)
_FIRST_WORD = re.compile(r'\A[a-z]+(?=[ ,:;]|\Z)')
_ENTITY = re.compile(r'&(#\d+|#x[0-9a-f]+|\w+);?', re.IGNORECASE)
_BASE64 = re.compile(r'[A-Za-z0-9+/=\s]+')


@dataclass(frozen=True)
class Piece:
    """Something that a cell printed or drew."""

    kind: str
    """'text', 'error', 'image/png' or 'image/jpeg'."""
    content: str
    alt: str = ''
    is_drawn: bool = False
    """Whether code drew it: a dark page then shows it dark."""


@dataclass(frozen=True)
class Check:
    """One graded cell, as the page tells of it."""

    name: str
    title: str
    score: float
    points: float
    status: str
    """'passed', 'partly', 'missed', 'by hand' or 'waiting'."""
    reason: str
    expected: str
    seen: str
    hint: str
    notes: tuple[str, ...]
    comment: str
    pieces: tuple[Piece, ...]
    source: str
    """What students may read of the check."""


@dataclass
class Part:
    """An answer, its outputs, and its checks."""

    name: str
    answer: str = ''
    is_text: bool = False
    pieces: list[Piece] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    comment: str = ''


def page(notebook: dict, about: dict, plain: str = '') -> str:
    """Return the page; `about` is nbgrader's: student, assignment, score, max_score, late_penalty.

    Grade cells hold what students may see, and scores: see feedback.GatherVerdicts. `plain` says
    why text and code are shown as they were typed. All of it is JSON.
    """
    notebook = nbformat.from_dict(notebook)
    parts, others = _parts(notebook)
    ours = notebook.metadata.get(KEY, {})
    problem = ours.get('problem', '')
    return _template(is_plain=bool(plain)).render(
        about=about,
        parts=[] if problem else [part for part in parts if part.checks or part.answer],
        checks=[check for part in parts for check in part.checks],
        others=others,
        problem=problem,
        title=ours.get('title', ''),
        no_sandbox='' if ours.get('in_sandbox', True) else NO_SANDBOX,
        notes=[note for note in (plain, *ours.get('notes', ())) if note not in ('', problem)],
    )


def _parts(notebook: NotebookNode) -> tuple[list[Part], list[tuple[str, list[Piece]]]]:
    """Return the exercises, and the other cells that put something out."""
    parts, others = [Part('')], []
    for cell in notebook.cells:
        kind, name = role(cell), grade_id(cell) or ''
        if kind == 'answer':
            marks = cell.metadata.nbgrader
            parts.append(Part(name, cell.source, cell.cell_type == 'markdown'))
            parts[-1].comment = marks.get('comment') or ''
            parts[-1].pieces += _pieces(cell)
            if marks.get('grade'):
                parts[-1].checks.append(_check(cell))
        elif kind == 'grade':
            parts[-1].checks.append(_check(cell))
        elif kind == 'locked' and name.startswith(f'{parts[-1].name}-'):
            parts[-1].pieces += _pieces(cell)
        elif cell.cell_type == 'code' and cell.get('outputs'):
            others.append((cell.source, list(_pieces(cell))))
    return parts, others


def _check(cell: NotebookNode) -> Check:
    marks, verdict = cell.metadata.nbgrader, cell.metadata.get(KEY, {})
    score, points = marks.get('score') or 0.0, marks.get('points') or 0.0
    name, is_answer = grade_id(cell), role(cell) == 'answer'
    status = 'passed' if score >= points else 'partly' if score > 0.0 else 'missed'
    status = 'waiting' if verdict.get('waits') else 'by hand' if verdict.get('by_hand') else status
    reason = verdict.get('reason') or _missing_reason(status, is_answer=is_answer)
    title = 'Your written answer' if is_answer else _title(cell) or name
    said = _REASON.fullmatch(reason)
    return Check(
        name=name,
        title=title,
        score=score,
        points=points,
        status=status,
        reason=reason,
        notes=tuple(verdict.get('notes', ())),
        comment='' if is_answer else marks.get('comment') or '',
        pieces=() if is_answer else tuple(_pieces(cell, about=title, reason=reason)),
        source='' if is_answer else cell.source.strip(),
        **(said.groupdict() if said else {'expected': '', 'seen': '', 'hint': ''}),
    )


def _title(cell: NotebookNode) -> str:
    """Return what a check is called: true of what failed."""
    if cell.metadata.get(KEY, {}).get('failed_at_grading'):
        return title_of_failure(cell.source)
    return title_of_check(cell.source)


def _missing_reason(status: str, *, is_answer: bool) -> str:
    if status == 'waiting':
        return 'Your instructor will read this.'
    if status == 'missed' and is_answer:
        return 'There was no answer.'
    return 'The reason is unknown.' if status == 'missed' else ''


def _pieces(cell: NotebookNode, *, about: str = '', reason: str | None = None) -> Iterator[Piece]:
    """Yield a cell's outputs, in forms that can do nothing: text, PNG and JPEG.

    Of a check, which has a `reason`, it is what stands beside that and the points.
    """
    for output in cell.get('outputs', ()):
        if output.output_type in ('error', 'execute_result') and reason is not None:
            continue
        if reason and output.get('text', '').strip() == reason:
            continue
        if output.output_type == 'error':
            yield _text_piece('error', '\n'.join(output.traceback) or output.evalue)
        elif output.output_type == 'stream':
            yield _text_piece('text', output.text)
        else:
            yield from _shown(output.data, about)
    for name, picture in cell.get('attachments', {}).items():
        yield from _shown({**picture, 'text/plain': name}, about, is_drawn=False)


def _shown(data: dict, about: str, *, is_drawn: bool = True) -> Iterator[Piece]:
    described = str(data.get('text/plain', ''))
    for kind in KINDS:
        if isinstance(data.get(kind), str) and _BASE64.fullmatch(data[kind]):
            if why := why_not_shown(data[kind]):
                yield _text_piece('text', f'[{why} was left out]')
                return
            described = '' if described.startswith('<') else described  # "<Figure size 640x480 …>"
            alt = described or (f'Picture of: {about}' if about else 'Picture that this cell drew')
            yield Piece(kind, ''.join(data[kind].split()), alt, is_drawn)
            return
    if described:
        yield _text_piece('text', described)


def _text_piece(kind: str, text: str) -> Piece:
    text = strip_ansi(text).rstrip('\n')
    if (more := len(text) - MAX_TEXT_CHARACTERS) > 0:
        text = f'{text[:MAX_TEXT_CHARACTERS]}\n[{more:,} more characters]'
    return Piece(kind, visible(text))


def _colour(source: str) -> Markup:
    return Markup(highlight(source, PythonLexer(), _CODE))


def _rich(text: str) -> Markup:
    """Turn markdown into the harmless part of its HTML."""
    html = bleach.clean(markdown2html(text), tags=_TAGS, attributes={}, strip=True)
    return Markup(_ENTITY.sub(lambda entity: _visible_entity(entity[0]), html))


def _visible_entity(entity: str) -> str:
    meant = unescape(entity)
    return entity if visible(meant) == meant else visible(meant)


def _words(text: str) -> Markup:
    """Show as code what stands between backticks."""
    return Markup(re.sub('`([^`]+)`', r'<code>\1</code>', str(escape(text))))


def _sentence(text: str) -> str:
    """Begin with a capital letter, unless that would misspell a name in the code."""
    return _FIRST_WORD.sub(lambda word: word[0].capitalize(), text)


def _number(value: float) -> str:
    return f'{value:.2f}'.rstrip('0').rstrip('.')


def _typed(text: str) -> Markup:
    """Show text in its own lines, as it was typed."""
    return Markup('<pre>{}</pre>').format(visible(text))


@cache
def _template(*, is_plain: bool) -> Template:
    return template(
        'page.html.j2',
        filters={
            'colour': escape if is_plain else _colour,
            'rich': _typed if is_plain else _rich,
            'words': _words,
            'sentence': _sentence,
            'number': _number,
        },
        values={
            'code_style': Markup(_CODE.get_style_defs('pre')),
            'dark_code_style': Markup(_CODE_IN_THE_DARK.get_style_defs('pre')),
        },
    )
