"""Record a report's results for the student's progress."""

from dataclasses import replace
from pathlib import Path

from my_robot_basics.language.speaking import in_language
from my_robot_basics.validate.progress.passed_answers import default_path, record
from my_robot_basics.validate.reports.report import ExerciseFeedback, Report


def remember(report: Report, notebook: Path) -> Report:
    """Record what passed and what did not; return the report, with notes of the recording."""
    results = {
        part.name: (part.answer, passed)
        for part in report.parts
        if part.answer and (passed := has_passed(part)) is not None
    }
    if not results:
        return report
    notes = record(default_path(), notebook.absolute().stem, results, notebook)
    told = tuple(in_language(report.language, note) for note in notes)
    return replace(report, notes=(*report.notes, *told))


def has_passed(part: ExerciseFeedback) -> bool | None:
    """Whether all of an exercise that can be checked here passed; None if that is unknown."""
    outcomes = {check.outcome for check in part.checks}
    if outcomes & {'failed', 'partial'}:
        return False
    return True if 'passed' in outcomes <= {'passed', 'at grading'} else None
