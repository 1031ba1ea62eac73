"""Make a report's entry for one graded cell from its verdict and its metadata."""

from collections.abc import Iterable

from nbformat import NotebookNode

from my_robot_basics.feedback.hidden import PLACE
from my_robot_basics.validate.lessons.cells import KEY, graded_id
from my_robot_basics.validate.lessons.lesson import Lesson
from my_robot_basics.validate.lessons.titles import title_of_check
from my_robot_basics.validate.reports.report import CheckFeedback, Outcome
from my_robot_basics.validate.verdicts.trouble import TROUBLE
from my_robot_basics.validate.verdicts.verdict import UNGRADED, Verdict


def make_check(
    lesson: Lesson, cell: NotebookNode, verdict: Verdict | None, outputs: Iterable[NotebookNode]
) -> CheckFeedback:
    """Return the entry of one graded cell; `verdict` is None if the cell was not run."""
    name = graded_id(cell)
    hidden = lesson.hidden.get(name)
    by_hand = cell.metadata[KEY].role == 'answer'
    return CheckFeedback(
        name=name,
        title='Your written answer' if by_hand else title_of_check(cell.source) or name,
        points=float(cell.metadata.nbgrader.get('points', 0)),
        outcome=_outcome(verdict, by_hand=by_hand, hidden=hidden, altered=name in lesson.altered),
        is_partly_hidden=hidden == 'part',
        earned=(verdict.score or 0.0) if verdict else 0.0,
        message=_message(verdict) if verdict else '',
        notes=tuple(n for n in verdict.notes if not n.startswith(TROUBLE)) if verdict else (),
        pictures=tuple(_pictures(outputs)),
        source='' if by_hand else cell.source.strip(),
    )


def troubles_of(verdicts: Iterable[Verdict]) -> tuple[str, ...]:
    """Return the sentences about errors in the student's cells of an exercise, each once."""
    notes = [note for verdict in verdicts for note in verdict.notes]
    return tuple(dict.fromkeys(note for note in notes if note.startswith(TROUBLE)))


def _message(verdict: Verdict) -> str:
    if verdict.failed_at_grading and verdict.details:
        # only the author's notebook has a hidden part to run, and says its inputs itself
        return f'{PLACE}{verdict.details}'
    if not verdict.reason.startswith(UNGRADED):
        return verdict.reason
    why = verdict.reason.removeprefix(UNGRADED)
    return f'Validate itself failed here, and your answer was not checked: {why}'


def _outcome(
    verdict: Verdict | None, *, by_hand: bool, hidden: str | None, altered: bool
) -> Outcome:
    if by_hand:
        return 'by hand'
    if altered:
        return 'not checked'
    if hidden == 'all':
        return 'at grading'
    if verdict is None or verdict.outcome == 'ungraded' or verdict.outcome == 'manual':
        return 'not checked'
    return verdict.outcome


def _pictures(outputs: Iterable[NotebookNode]) -> Iterable[dict[str, str]]:
    for output in outputs:
        if png := output.get('data', {}).get('image/png'):
            yield {'png': ''.join(png.split()), 'alt': output.data.get('text/plain', '')}
