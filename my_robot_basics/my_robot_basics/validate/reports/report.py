"""The results of *Validate* for each exercise and check, as data that any front end can show."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import reduce
from typing import Literal

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.sentences import SENTENCES
from my_robot_basics.language.speaking import in_language, put
from my_robot_basics.validate.reports.report_words import front_end_texts

Outcome = Literal['passed', 'partial', 'failed', 'at grading', 'by hand', 'not checked']
MARKS = {'passed': '✓', 'partial': '✗', 'failed': '✗'}
MARKS |= {'at grading': '…', 'by hand': '…', 'not checked': '?'}


@dataclass(frozen=True)
class CheckFeedback:
    """The result of one graded cell."""

    name: str
    """Its grade id."""
    title: str
    points: float
    outcome: Outcome
    is_partly_hidden: bool
    """Whether it also has a hidden part, which is checked at grading."""
    earned: float = 0.0
    """The points that the visible part gives so far."""
    message: str = ''
    notes: tuple[str, ...] = ()
    """Remarks that cost no points."""
    pictures: tuple[dict[str, str], ...] = ()
    """{'png': base64, 'alt': text} of each picture that the check has drawn."""
    source: str = ''
    """The visible source of the check."""


@dataclass(frozen=True)
class ExerciseFeedback:
    """The results of one exercise."""

    name: str
    troubles: tuple[str, ...]
    """Errors in the student's own cells, as sentences."""
    checks: tuple[CheckFeedback, ...]
    answer: str = ''  # the hash of the judged answer: see passed_answers.answer_of


@dataclass(frozen=True)
class Report:
    """The results of a notebook."""

    notebook: str
    parts: tuple[ExerciseFeedback, ...]
    notes: tuple[str, ...]
    language: str = ENGLISH
    """The notebook's language, in which the report is shown."""

    @property
    def checks(self) -> list[CheckFeedback]:
        """All checks, in order."""
        return [check for part in self.parts for check in part.checks]

    def with_words(
        self, put: Callable[[str], str], *, title: Callable[[str], str] = str
    ) -> 'Report':
        """Return the report with `put` applied to its sentences, and `title` to its titles."""

        def put_all(lines: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(put(line) for line in lines)

        parts = [
            replace(
                part,
                troubles=put_all(part.troubles),
                checks=tuple(
                    replace(
                        c, title=title(c.title), message=put(c.message), notes=put_all(c.notes)
                    )
                    for c in part.checks
                ),
            )
            for part in self.parts
        ]
        return replace(self, parts=tuple(parts), notes=put_all(self.notes))

    @property
    def passed(self) -> bool:
        """Whether everything that can be checked here was checked and passed."""
        return all(c.outcome not in ('failed', 'partial', 'not checked') for c in self.checks)

    @property
    def summary(self) -> str:
        """Return the overall result in one line."""
        said = self._visible()
        total = _number(sum(check.points for check in self.checks))
        waiting = [check for check in self.checks if _waits(check)]
        at_grading = sum(check.earned or check.points for check in waiting)
        if at_grading == 1:
            said.append(f'{_number(at_grading)} of {total} points is decided at grading.')
        elif at_grading:
            said.append(f'{_number(at_grading)} of {total} points are decided at grading.')
        by_hand = sum(check.points for check in self.checks if check.outcome == 'by hand')
        if by_hand:
            said.append(f'A person gives {_points(by_hand)} for what you have written.')
        translated = [in_language(self.language, sentence) for sentence in said]
        return reduce(self._joined, translated)

    def as_data(self) -> dict:
        """Return all of it as JSON data."""
        told = {'summary': self.summary, 'passed': self.passed, 'marks': MARKS}
        return {**asdict(self), **told, 'words': front_end_texts(self.language)}

    def _joined(self, one: str, other: str) -> str:
        return put(self.language, SENTENCES, sentence=one, other=other)

    def _visible(self) -> list[str]:
        visible = [c for c in self.checks if c.outcome not in ('at grading', 'by hand')]
        failed = [check for check in visible if check.outcome in ('failed', 'partial')]
        unknown = [check for check in visible if check.outcome == 'not checked']
        if not visible:
            return ['Nothing here can be checked before grading.']
        if not failed and not unknown:
            return ['All visible checks pass.']
        said = []
        if failed:
            lost = _points(sum(check.points - check.earned for check in failed))
            if len(failed) == 1:
                said.append(f'1 of {len(visible)} visible checks fails: {lost} missing.')
            else:
                said.append(
                    f'{len(failed)} of {len(visible)} visible checks fail: {lost} missing.'
                )
        if unknown:
            said.append(f'{len(unknown)} of {len(visible)} could not be checked.')
        return said


def _waits(check: CheckFeedback) -> bool:
    """Whether points of this check are decided only at grading."""
    return check.outcome == 'at grading' or (check.earned > 0 and check.is_partly_hidden)


def _points(number: float) -> str:
    return f'{_number(number)} point{"" if number == 1 else "s"}'


def _number(value: float) -> str:
    return f'{value:g}'
