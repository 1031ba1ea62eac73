"""What *Validate* says of each exercise and check: data that any front end can show."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Literal

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.speaking import in_language
from my_robot_basics.validate.report_words import words_around

Outcome = Literal['passed', 'partial', 'failed', 'at grading', 'by hand', 'not checked']
MARKS = {'passed': '✓', 'partial': '✗', 'failed': '✗'}
MARKS |= {'at grading': '…', 'by hand': '…', 'not checked': '?'}


@dataclass(frozen=True)
class CheckFeedback:
    """One graded cell."""

    name: str
    """Its grade id."""
    title: str
    points: float
    outcome: Outcome
    is_partly_hidden: bool
    """Whether more of it is checked at grading."""
    earned: float = 0.0
    """The points that what can be seen here leaves."""
    message: str = ''
    notes: tuple[str, ...] = ()
    """What costs no points, and is good to know."""
    pictures: tuple[dict[str, str], ...] = ()
    """{'png': base64, 'alt': text}: what the check has drawn."""
    source: str = ''
    """What students may read of the check."""


@dataclass(frozen=True)
class ExerciseFeedback:
    """One exercise."""

    name: str
    troubles: tuple[str, ...]
    """What went wrong in the student's own cells."""
    checks: tuple[CheckFeedback, ...]
    answer: str = ''  # tells the answer that was judged from any other


@dataclass(frozen=True)
class Report:
    """All that is said of a notebook."""

    notebook: str
    parts: tuple[ExerciseFeedback, ...]
    notes: tuple[str, ...]
    language: str = ENGLISH
    """That of the notebook, in which the report is read."""

    @property
    def checks(self) -> list[CheckFeedback]:
        """All checks, in order."""
        return [check for part in self.parts for check in part.checks]

    def with_words(
        self, put: Callable[[str], str], *, title: Callable[[str], str] = str
    ) -> 'Report':
        """Return the same report with each of its sentences, and titles, put otherwise."""

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
        """Whether all that can be checked here was, and passed."""
        return all(c.outcome not in ('failed', 'partial', 'not checked') for c in self.checks)

    @property
    def summary(self) -> str:
        """What it comes to, in one line."""
        said = [self._visible()]
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
        return in_language(self.language, ' '.join(said))

    def as_data(self) -> dict:
        """Return all of it as what JSON can say."""
        told = {'summary': self.summary, 'passed': self.passed, 'marks': MARKS}
        return {**asdict(self), **told, 'words': words_around(self.language)}

    def _visible(self) -> str:
        visible = [c for c in self.checks if c.outcome not in ('at grading', 'by hand')]
        failed = [check for check in visible if check.outcome in ('failed', 'partial')]
        unknown = [check for check in visible if check.outcome == 'not checked']
        if not visible:
            return 'Nothing here can be checked before grading.'
        if not failed and not unknown:
            return 'All visible checks pass.'
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
        return ' '.join(said)


def _waits(check: CheckFeedback) -> bool:
    """Whether its points are still open when all that can be seen is right."""
    return check.outcome == 'at grading' or (check.earned > 0 and check.is_partly_hidden)


def _points(number: float) -> str:
    return f'{_number(number)} point{"" if number == 1 else "s"}'


def _number(value: float) -> str:
    return f'{value:g}'
