"""The parts of a feedback page: answers, outputs, checks and pictures of a graded notebook."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.sentences import REASON
from my_robot_basics.language.speaking import in_language, sentences
from my_robot_basics.validate.kernels.pictures import KINDS, why_not_shown
from my_robot_basics.validate.lessons.titles import title_of_check, title_of_failure
from my_robot_basics.validate.verdicts.trouble import TROUBLE
from nbconvert.filters import strip_ansi
from nbformat import NotebookNode

from grader.common.text import visible
from grader.notebook.restore import KEY, grade_id, role
from grader.report.shown_outputs import in_page_language

MAX_TEXT_CHARACTERS = 5_000
"""How much of one output is shown."""
AT_GRADING = 'checked at grading'  # what a check that is hidden as a whole prints

_REASON = '(?s)expected (?P<expected>.+?), saw (?P<seen>.+): (?P<hint>{hint})'
_BASE64 = re.compile(r'[A-Za-z0-9+/=\s]+')


@dataclass(frozen=True)
class CellOutput:
    """Text or a picture that a cell printed or drew."""

    kind: str
    """'text', 'error', 'image/png' or 'image/jpeg'."""
    content: str
    alt: str = ''
    is_drawn: bool = False
    """Whether code drew it: then a page in dark mode shows it dark."""


@dataclass(frozen=True)
class CheckedCell:
    """One graded cell, as the page shows it."""

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
    troubles: tuple[str, ...]
    """What went wrong in the student's own cells, if points are missing: shown first."""
    notes: tuple[str, ...]
    comment: str
    outputs: tuple[CellOutput, ...]
    source: str
    """The part of the check that students may read."""


@dataclass
class PageSection:
    """An exercise on the page: its answer, its outputs, and its checks."""

    name: str
    answer: str = ''
    is_text: bool = False
    outputs: list[CellOutput] = field(default_factory=list)
    checks: list[CheckedCell] = field(default_factory=list)
    comment: str = ''


def find_sections(
    notebook: NotebookNode, language: str = ENGLISH
) -> tuple[list[PageSection], list[tuple[str, list[CellOutput]]]]:
    """Return the exercises, and source and outputs of other cells that have outputs."""
    sections, others = [PageSection('')], []
    for cell in notebook.cells:
        kind, name = role(cell), grade_id(cell) or ''
        if kind == 'answer':
            marks = cell.metadata.nbgrader
            sections.append(PageSection(name, cell.source, cell.cell_type == 'markdown'))
            sections[-1].comment = marks.get('comment') or ''
            sections[-1].outputs += _outputs(cell, language)
            if marks.get('grade'):
                sections[-1].checks.append(_check(cell, language))
        elif kind == 'grade':
            sections[-1].checks.append(_check(cell, language))
        elif kind == 'locked' and name.startswith(f'{sections[-1].name}-'):
            sections[-1].outputs += _outputs(cell, language)
        elif cell.cell_type == 'code' and cell.get('outputs'):
            others.append((cell.source, list(_outputs(cell, language))))
    return sections, others


def _check(cell: NotebookNode, language: str = ENGLISH) -> CheckedCell:
    marks, verdict = cell.metadata.nbgrader, cell.metadata.get(KEY, {})
    score, points = marks.get('score') or 0.0, marks.get('points') or 0.0
    name, is_answer = grade_id(cell) or '', role(cell) == 'answer'
    status = 'passed' if score >= points else 'partly' if score > 0.0 else 'missed'
    status = 'waiting' if verdict.get('waits') else 'by hand' if verdict.get('by_hand') else status
    reason = verdict.get('reason') or _missing_reason(status, is_answer=is_answer)
    title = 'Your written answer' if is_answer else _title(cell) or name
    told = tuple(verdict.get('notes', ()))
    troubles = tuple(note for note in told if note.startswith(TROUBLE) and score < points)
    return CheckedCell(
        name=name,
        title=title,
        score=score,
        points=points,
        status=status,
        reason=reason,
        troubles=troubles,
        notes=tuple(note for note in told if note not in troubles),
        comment='' if is_answer else marks.get('comment') or '',
        outputs=() if is_answer else tuple(_outputs(cell, language, about=title, reason=reason)),
        source='' if is_answer else cell.source.strip(),
        **_parts(reason, verdict.get('hint', ''), language),
    )


def _parts(reason: str, hint: str, language: str) -> dict[str, str]:
    """Split a reason into what was expected, what was seen, and a hint; '' for each if it can't.

    Both what was seen and the hint may contain a colon: the verdict has the exact hint, and the
    catalogue of the language has the translation of each part.
    """
    said = re.fullmatch(_REASON.format(hint=re.escape(hint) or '.+'), reason)
    if said is None:
        return {'expected': '', 'seen': '', 'hint': ''}
    parts = {} if language == ENGLISH else sentences(language).parts(REASON, reason)
    return parts or said.groupdict()


def _title(cell: NotebookNode) -> str:
    """Return the title of a check, which is true of a failed check, too."""
    if cell.metadata.get(KEY, {}).get('failed_at_grading'):
        return title_of_failure(cell.source)
    return title_of_check(cell.source)


def _missing_reason(status: str, *, is_answer: bool) -> str:
    if status == 'waiting':
        return 'Your instructor will read this.'
    if status == 'missed' and is_answer:
        return 'There was no answer.'
    return 'The reason is unknown.' if status == 'missed' else ''


def _outputs(
    cell: NotebookNode, language: str, *, about: str = '', reason: str | None = None
) -> Iterator[CellOutput]:
    """Yield a cell's outputs in harmless forms: text, PNG and JPEG.

    For a check, which has a `reason`, errors, points and a repetition of the reason are skipped.
    """
    for output in cell.get('outputs', ()):
        if reason is not None and (
            output.output_type in ('error', 'execute_result')
            or output.get('text', '').strip() in {reason, AT_GRADING} - {''}
        ):
            continue
        shown = in_page_language(output, language)
        if output.output_type == 'error':
            yield _text_piece('error', '\n'.join(shown.traceback) or output.evalue, language)
        elif output.output_type == 'stream':
            yield _text_piece('text', shown.text, language)
        else:
            yield from show_data(shown.data, about, language)
    for name, picture in cell.get('attachments', {}).items():
        yield from show_data({**picture, 'text/plain': name}, about, language, is_drawn=False)


def show_data(
    data: dict, about: str, language: str = ENGLISH, *, is_drawn: bool = True
) -> Iterator[CellOutput]:
    """Yield the first harmless form of an output's data: a picture, or text."""
    described = str(data.get('text/plain', ''))
    for kind in KINDS:
        if isinstance(data.get(kind), str) and _BASE64.fullmatch(data[kind]):
            if why := why_not_shown(data[kind]):
                yield CellOutput('text', in_language(language, f'[{why} was left out]'))
                return
            described = '' if described.startswith('<') else described  # "<Figure size 640x480 …>"
            ours = f'Picture of: {about}' if about else 'Picture that this cell drew'
            alt = described or in_language(language, ours)
            yield CellOutput(kind, ''.join(data[kind].split()), alt, is_drawn)
            return
    if described:
        yield _text_piece('text', described, language)


def _text_piece(kind: str, text: str, language: str) -> CellOutput:
    text = strip_ansi(text).rstrip('\n')
    if (more := len(text) - MAX_TEXT_CHARACTERS) > 0:
        rest = in_language(language, f'[{more:,} more characters]')
        text = f'{text[:MAX_TEXT_CHARACTERS]}\n{rest}'
    return CellOutput(kind, visible(text))
