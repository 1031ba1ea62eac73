"""Turn the result of a grade cell into a verdict with its reason, and write it into the cell."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import nbformat
from nbformat import NotebookNode

from my_robot_basics.feedback import hidden
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.limits import REPLIES_SEC
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.lessons.cells import KEY, graded_id, role
from my_robot_basics.validate.verdicts.second_look import DISTURBED, STARVED
from my_robot_basics.validate.verdicts.trouble import describe_cell_error

Outcome = Literal['passed', 'partial', 'failed', 'ungraded', 'manual']
SCORED = ('passed', 'partial', 'failed')
"""Outcomes with a score, which need no decision by a person."""

NOTE = 'note: '
"""A printed line of a check that starts with this costs no points and is shown to the student."""
UNGRADED = 'not graded, a person has to look at it: '
"""How the reason begins if the grader itself failed."""
TOO_SLOW = (
    'the check has not ended, because your code took over '
    f'{REPLIES_SEC:.0f} s to answer what it asks: look for a sleep or a long loop in what it calls'
)
"""The reason of a failed check that had to wait for the student's code nearly all the time."""
_FAILURES = ('CheckFailed', 'PartlyRight', STARVED, DISTURBED, 'AssertionError')
_SHOWN = ('display_data', 'stream')
_BROKEN = re.compile('the test kernel (crashed with|could not be interrupted)')


@dataclass(frozen=True)
class Verdict:
    """The result of one grade cell."""

    grade_id: str
    outcome: Outcome
    points: float
    """The most that the cell can earn."""
    reason: str
    """Why it did not earn all of them; empty when it passed."""
    notes: tuple[str, ...] = ()
    details: str = ''
    """For instructors only: what was expected and seen in a hidden part."""
    earned: float = 0.0
    """The points of a `partial` outcome."""
    failed_at_grading: bool = False
    """Whether its visible part passed and its hidden part failed."""
    hint: str = ''
    """The words at the reason's end that are its hint, if the check has reported them."""

    @property
    def score(self) -> float | None:
        """Points earned; None when a person has to decide."""
        scores = {'passed': self.points, 'partial': self.earned, 'failed': 0.0}
        return scores.get(self.outcome)


def judge(cell: NotebookNode, run: CellRun | None, own: Iterable[tuple[str, CellRun]]) -> Verdict:
    """Judge a grade cell by its run; `run` is None if the student's kernel ended before it.

    `own` are the runs of the student's cells of the exercise. Raises RoomFailure if the check
    did not reach a verdict.
    """
    name, points, own = graded_id(cell), float(cell.metadata.nbgrader.points), list(own)
    if run is None:
        reason = 'the kernel of your notebook ended before the check: ' + _who_ended_it(own)
        return Verdict(name, outcome='failed', points=points, reason=reason)
    notes = tuple(_notes(run))
    if run.ran_to_end:
        return Verdict(name, outcome='passed', points=points, reason='', notes=notes)
    if run.replies_sec >= REPLIES_SEC:
        return Verdict(name, 'failed', points, reason=TOO_SLOW, notes=notes)
    if run.error is None or run.error.ename not in _FAILURES:
        raise RoomFailure(f'the check `{name}` came to no verdict: {_what_happened(run)}')
    reason = run.error.evalue.strip() or 'the check failed and gave no reason'
    details = hidden.details_in(run.outputs)
    if run.error.ename == 'AssertionError' and hidden.has_reached_hidden_part(run.outputs):
        reason, details = _in_words(reason, cell), reason
    notes += tuple(sentence for each in own if (sentence := describe_cell_error(*each)))
    # a signal's number may be a hidden input
    if run.ending and hidden.has_reached_hidden_part(run.outputs):
        notes += ('in the part checked at grading, what you started has ended',)
        details = '; '.join(filter(None, (details, run.ending)))
    elif run.ending:
        notes += (f'what you started has ended: {run.ending}',)
    beyond, hint = (
        hidden.failed_only_in_hidden_part(run.outputs),
        hidden.hint_in(run.outputs, reason),
    )
    if run.error.ename != 'PartlyRight':
        return Verdict(name, 'failed', points, reason, notes, details, 0.0, beyond, hint)
    earned = hidden.points_in(run.outputs)
    if not 0.0 < earned < points:
        raise RoomFailure(
            f'the check `{name}` came to no verdict: {earned:g} of {points:g} points'
        )
    return Verdict(name, 'partial', points, reason, notes, details, earned, beyond, hint)


def leave_ungraded(cell: NotebookNode, why: str) -> Verdict:
    """Leave a grade cell to a person, because the grader itself failed."""
    reason = UNGRADED + why
    return Verdict(
        graded_id(cell),
        outcome='ungraded',
        points=float(cell.metadata.nbgrader.points),
        reason=reason,
    )


def fail_all_checks(notebook: NotebookNode, problem: str) -> list[Verdict]:
    """Fail every grade cell of a notebook that could not be read."""
    verdicts = []
    for cell in notebook.cells:
        if role(cell) == 'grade' and cell.cell_type == 'code':
            points = float(cell.metadata.nbgrader.points)
            verdicts.append(Verdict(graded_id(cell), 'failed', points, reason=problem))
            write_verdict(cell, verdicts[-1], [])
    return verdicts


def write_verdict(cell: NotebookNode, verdict: Verdict, outputs: Iterable[NotebookNode]) -> None:
    """Write a verdict into its grade cell, in the form that nbgrader scores.

    Text on stdout and pictures stay. A failure becomes one `error` output with the reason and no
    line of the test; partial credit becomes the reason as text and the points as the result.
    """
    shown = hidden.visible_outputs(list(outputs))
    cell.outputs = [out for out in shown if out.output_type in _SHOWN and not _is_stderr(out)]
    cell.metadata[KEY] = {
        'role': 'grade',
        'outcome': verdict.outcome,
        'reason': verdict.reason,
        'notes': list(verdict.notes),
        'details': verdict.details,
        'earned': verdict.earned,
        'failed_at_grading': verdict.failed_at_grading,
        'hint': verdict.hint,
    }
    if verdict.outcome == 'failed':
        error = nbformat.v4.new_output(
            'error', ename='CheckFailed', evalue=verdict.reason, traceback=[verdict.reason]
        )
        cell.outputs.append(error)
    elif verdict.outcome in ('ungraded', 'partial'):
        text = verdict.reason + '\n'
        cell.outputs.append(nbformat.v4.new_output('stream', name='stdout', text=text))
    if verdict.outcome == 'partial':
        data = {'text/plain': repr(verdict.earned)}
        cell.outputs.append(nbformat.v4.new_output('execute_result', data=data))


def is_broken(reason: str) -> bool:
    """Whether the reason of an `ungraded` outcome is that the test kernel crashed or hung."""
    return bool(_BROKEN.search(reason))


def _notes(run: CellRun) -> Iterable[str]:
    for output in hidden.visible_outputs(run.outputs):
        for line in output.get('text', '').splitlines():
            if line.startswith(NOTE):
                yield line.removeprefix(NOTE)


def _in_words(reason: str, cell: NotebookNode) -> str:
    """Return the reason of a failed `assert` in a hidden part: only words from the cell itself."""
    words = reason if reason in cell.source else 'the check failed'
    return f'{hidden.PLACE}{words}'


def _who_ended_it(own: list[tuple[str, CellRun]]) -> str:
    causes = [sentence for each in own if (sentence := describe_cell_error(*each))]
    return causes[0] if causes else 'something that your code left running ended it'


def _what_happened(run: CellRun) -> str:
    if run.died and run.timed_out:
        return 'the test kernel could not be interrupted'
    if run.crash:
        return f'the test kernel crashed with {run.crash}'
    if run.died:
        return 'the test kernel ended'
    if run.timed_out:
        return 'it did not end in time'
    return f'it stopped with {run.error.ename}' if run.error else 'it did not report its end'


def _is_stderr(output: NotebookNode) -> bool:
    return output.output_type == 'stream' and output.name == 'stderr'
