"""Whose turn it is: fair between students; one submission of each at a time, the newest first."""

from collections.abc import Collection, Iterator, Mapping, Sequence

from grader.serving.queue import Arrival
from grader.storage.resubmissions import ResubmissionRules

HOUR_SEC = 3_600.0
Starts = Mapping[tuple[str, str], Sequence[float]]
"""By student and assignment: when gradings started, in Unix time."""


def next_turn(
    waiting: Sequence[Arrival],
    busy: Collection[str],
    starts: Starts,
    rules: ResubmissionRules,
    now: float,
) -> Arrival | None:
    """Return the submission to grade next; None if there is none.

    Students whose last turn is longest ago come first; those in `busy`, who have a submission
    being graded, are skipped.
    """
    turns = []
    for student, theirs in _by_student(waiting):
        allowed = [
            each
            for each in theirs
            if not reason_to_wait(starts.get(each.submission_key, ()), rules, now)
        ]
        if allowed and student not in busy:
            newest = max(allowed, key=lambda each: (each.arrived, each.number))
            last = max((max(at) for whose, at in starts.items() if whose[0] == student), default=0)
            turns.append((last, newest.arrived, newest.number, newest))
    return min(turns)[-1] if turns else None


def replaced_by(chosen: Arrival, waiting: Sequence[Arrival]) -> list[Arrival]:
    """Return earlier submissions for the same lesson as `chosen`: they need not be graded."""
    return [
        each
        for each in waiting
        if each.submission_key == chosen.submission_key
        and (each.arrived, each.number) < (chosen.arrived, chosen.number)
    ]


def reason_to_wait(starts: Sequence[float], rules: ResubmissionRules, now: float) -> str:
    """Return why the rules do not allow one more grading now, or ''."""
    if rules.in_total is not None and len(starts) >= rules.in_total:
        return (
            f'{len(starts)} were graded, and the course grades at most {rules.in_total}: it is '
            'kept, but not graded'
        )
    recent = [at for at in starts if at > now - HOUR_SEC]
    if rules.per_hour is not None and len(recent) >= rules.per_hour:
        minutes = (recent[-rules.per_hour] + HOUR_SEC - now) / 60
        return (
            f'{len(recent)} were graded in the last hour, and the course grades at '
            f'most {rules.per_hour}: the next is graded in {max(1, round(minutes))} min'
        )
    return ''


def _by_student(waiting: Sequence[Arrival]) -> Iterator[tuple[str, list[Arrival]]]:
    """Yield each student with the newest submission for each assignment."""
    newest: dict[tuple[str, str], Arrival] = {}
    for each in sorted(waiting, key=lambda each: (each.arrived, each.number)):
        newest[each.submission_key] = each
    for student in sorted({whose[0] for whose in newest}):
        yield student, [each for whose, each in newest.items() if whose[0] == student]
