"""Whose file it is: student, assignment and time, read off where it lay and how it is named."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from grader.incoming import Incoming, wanted
from grader.naming import Naming, Owner, date_in
from grader.students import Unclear, problem_of_id
from grader.submission import TIMESTAMP


@dataclass(frozen=True)
class HandIn:
    """One assignment of one student, as it came in."""

    student_id: str
    assignment: str
    notebook: Incoming
    extra: dict[str, Path] = field(default_factory=dict)
    """The student's Python files beside it, by name."""
    handed_in: datetime | None = None
    """In UTC; None where nothing tells."""


@dataclass(frozen=True)
class Left:
    """A file that was not taken."""

    incoming: Incoming
    reason: str
    matters: bool = True
    """Whether a person should look at it; else nobody would grade it anyway."""


def match(
    found: Sequence[Incoming], assignments: Iterable[str], *, file_times: bool = False
) -> tuple[list[HandIn], list[Left]]:
    """Sort what came in: submissions, each student's in their order, and the rest with reasons.

    `file_times` takes the time of a file for the time it was handed in, where nothing else tells.
    """
    naming = Naming(found, assignments)
    owners: dict[Incoming, Owner] = {}
    rest = [Left(each, each.problem) for each in found if each.problem]
    beside: dict[tuple[str, ...], dict[str, Incoming]] = defaultdict(dict)
    for each in (each for each in found if not each.problem):
        if each.parts[-1].lower().endswith('.ipynb'):
            try:
                owners[each] = naming.owner(each)
            except Unclear as unclear:
                rest.append(Left(each, str(unclear)))
        elif wanted(each.parts[-1]):
            beside[each.parts[:-1]][each.parts[-1]] = each
        else:
            rest.append(Left(each, 'neither a notebook nor Python', matters=False))
    hand_ins, used = [], set()
    for notebook, owner in owners.items():
        files = beside[notebook.parts[:-1]] if owner.by_folder or notebook.archive else {}
        stamp = files.get(TIMESTAMP) if not notebook.archive else None
        when = owner.handed_in or (date_of(stamp.file) if stamp else None)
        if when is None and file_times:
            when = notebook.modified
        extra = {
            name: each.file
            for name, each in files.items()
            if name.endswith('.py') and not problem_of_id(name)
        }
        hand_ins.append(HandIn(owner.student_id, owner.assignment, notebook, extra, when))
        used |= {files[name] for name in extra}
        used |= {stamp} if stamp and date_of(stamp.file) else set()
    for each in (each for files in beside.values() for each in files.values()):
        if each not in used:
            rest.append(_not_taken(each))
    return _in_order(hand_ins, rest), rest


def date_of(stamp: Path) -> datetime | None:
    """Read nbgrader's timestamp.txt; None where there is no such file, or no date in it."""
    if not stamp.is_file() or stamp.is_symlink():
        return None
    with stamp.open('rb') as file:
        return date_in(file.read(200).decode(errors='replace'))


def _not_taken(each: Incoming) -> Left:
    """Say why a file that lies beside notebooks goes with none of them."""
    if each.parts[-1] != TIMESTAMP:
        return Left(each, "it lies beside no notebook, or beside several students'", matters=False)
    if each.archive:
        return Left(each, "a time in a student's own archive is not believed")
    if date_of(each.file) is None:
        return Left(each, 'it holds no date')
    return Left(each, 'it lies beside no notebook of one student')


def _in_order(hand_ins: list[HandIn], rest: list[Left]) -> list[HandIn]:
    """Sort by student, assignment and time; what can't be put in an order joins the rest."""
    whose: dict[tuple[str, str], list[HandIn]] = defaultdict(list)
    for each in hand_ins:
        whose[each.student_id, each.assignment].append(each)
    ordered = []
    for (student, assignment), several in sorted(whose.items()):
        times = {each.handed_in for each in several}
        if len(times) == len(several) and (None not in times or len(several) == 1):
            ordered += sorted(several, key=lambda each: each.handed_in or datetime.min)
            continue
        contents = {_content(each) for each in several}
        if len(contents) == 1:
            ordered.append(several[0])
            rest += [Left(each.notebook, 'the same again', matters=False) for each in several[1:]]
            continue
        others = f'one of {len(several)} notebooks for {assignment} by {student}'
        reason = f'{others}, and nothing tells which is the latest'
        rest += [Left(each.notebook, reason) for each in several]
    return ordered


def _content(each: HandIn) -> tuple[bytes, ...]:
    files = sorted(each.extra.items())
    return (each.notebook.file.read_bytes(), *(path.read_bytes() for _, path in files))
