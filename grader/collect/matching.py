"""Whose file it is: student, assignment and time, read off where it lay and how it is named."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from hashlib import sha256
from pathlib import Path

from grader.collect.incoming import Incoming, is_notebook
from grader.collect.owners import find_owners, why_not_theirs
from grader.collect.package_folders import (
    NO_NOTEBOOK,
    choose,
    first_of,
    grouped,
    matters,
    number_of,
    split,
)
from grader.collect.platforms import PlatformLabel
from grader.collect.uploads import wanted
from grader.common.dates import date_of
from grader.common.student_names import problem_of_id
from grader.notebook.submission import SECRET, TIMESTAMP


@dataclass(frozen=True)
class MatchedFile:
    """One assignment of one student, as it came in."""

    student_id: str
    assignment: str
    notebook: Incoming
    extra: dict[str, Path] = field(default_factory=dict)
    """The student's Python files beside it, by name, and those of packages, by path."""
    handed_in: datetime | None = None
    """In UTC; None where nothing tells."""
    label: PlatformLabel | None = None
    """What a course platform said of the student."""
    remark: str = ''
    """What a person may want to look at, although it was taken."""
    secret: Path | None = None
    """nbgrader's, which names the page of feedback in the exchange."""
    left_out: tuple[str, ...] = ()
    """What its student is told of files that were not taken."""


@dataclass(frozen=True)
class UntakenFile:
    """A file that was not taken."""

    incoming: Incoming
    reason: str
    matters: bool = True
    """Whether a person should look at it; else nobody would grade it anyway."""


def match(
    found: Sequence[Incoming],
    assignments: Iterable[str],
    *,
    packages: Mapping[str, Iterable[str]] | None = None,
    students: Iterable[str] = (),
    file_times: bool = False,
) -> tuple[list[MatchedFile], list[UntakenFile]]:
    """Sort what came in: submissions, each student's in their order, and the rest with reasons.

    `packages` are the ROS packages that are handed in with each assignment. `students` are those
    who are known from before. `file_times` takes the time of a file for the
    time it was handed in, where nothing else tells.
    """
    asked_for = {name: tuple(several) for name, several in (packages or {}).items()}
    found, folders = split(found, {each for several in asked_for.values() for each in several})
    beside_notebooks = grouped(folders)
    rest = [UntakenFile(each, each.problem) for each in found if each.problem]
    beside: dict[tuple[str, ...], dict[str, Incoming]] = defaultdict(dict)
    for each in (each for each in found if not each.problem and not is_notebook(each)):
        if wanted(each.parts[-1:]):
            beside[each.parts[:-1]][each.parts[-1]] = each
        else:
            rest.append(UntakenFile(each, 'neither a notebook nor Python', matters=False))
    owners, remarks, problems = find_owners(found, assignments, students)
    rest += [UntakenFile(each, problem) for each, problem in problems.items()]
    hand_ins, used, others = [], set(), dict[Incoming, str]()
    for notebook, owner in owners.items():
        files = beside[notebook.parts[:-1]] if owner.by_folder or notebook.archive else {}
        foreign = {e: why for e in files.values() if (why := why_not_theirs(e, owner.student_id))}
        files = {name: each for name, each in files.items() if each not in foreign}
        others |= foreign
        stamp = files.get(TIMESTAMP) if not (notebook.archive or owner.label) else None
        secret = files.get(SECRET) if not (notebook.archive or owner.label) else None
        modules = {
            name: each
            for name, each in files.items()
            if name.endswith('.py') and not problem_of_id(name)
        }
        changed = [each.changed for each in (notebook, *modules.values()) if each.changed]
        extra = {name: each.readable for name, each in modules.items()}
        left_out: list[str] = []
        for package in asked_for.get(owner.assignment, ()):
            number = '' if owner.by_folder or notebook.archive else number_of(notebook)
            if not (number or owner.by_folder or notebook.archive):
                continue
            key = (package, notebook.parts[:-1], number)
            if there := first_of(owner.student_id, beside_notebooks.get(key, ())):
                chosen = choose(there, owner.student_id)
                extra |= chosen.taken
                changed += chosen.changed
                left_out += chosen.clauses(package)
                rest += [UntakenFile(e, why, matters=matters(why)) for e, why in chosen.left]
                folders = [each for each in folders if each is not there]
        # whoever wrote the folder could claim any time, and go on with any file of it
        when = None if notebook.changed else owner.handed_in or _stamped(stamp)
        claimed = notebook.modified if file_times else None
        when = max([*changed, *([when] if when else [])], default=claimed)
        hand_ins.append(
            MatchedFile(
                owner.student_id,
                owner.assignment,
                notebook,
                extra,
                when,
                owner.label,
                remarks[notebook],
                secret.readable if secret else None,
                tuple(left_out),
            )
        )
        used |= {*modules.values(), *([secret] if secret else [])}
        used |= {stamp} if stamp and date_of(stamp.readable) else set()
    rest += [UntakenFile(each, NO_NOTEBOOK) for folder in folders for each in folder.members]
    rest += [UntakenFile(each, why) for each, why in others.items()]
    uploads = {notebook.parts[:-1] for notebook, owner in owners.items() if owner.label}
    for folder, files in beside.items():
        left = (each for each in files.values() if each not in used and each not in others)
        rest += [_not_taken(each, in_upload=folder in uploads) for each in left]
    return _in_order(hand_ins, rest), rest


def _stamped(stamp: Incoming | None) -> datetime | None:
    """Return the time that stands in a file of nbgrader's, which its student did not write."""
    return date_of(stamp.readable) if stamp and not stamp.login else None


def _not_taken(each: Incoming, *, in_upload: bool) -> UntakenFile:
    """Say why a file that lies beside notebooks goes with none of them."""
    if each.parts[-1] == SECRET:
        return UntakenFile(each, 'a secret of no submission from the exchange', matters=False)
    if each.parts[-1] != TIMESTAMP:
        return UntakenFile(
            each, "it lies beside no notebook, or beside several students'", matters=False
        )
    if each.archive or in_upload:
        where = 'archive' if each.archive else 'upload'
        return UntakenFile(each, f"a time in a student's own {where} is not believed")
    if date_of(each.readable) is None:
        return UntakenFile(each, 'it holds no date')
    return UntakenFile(each, 'it lies beside no notebook of one student')


def _in_order(hand_ins: list[MatchedFile], rest: list[UntakenFile]) -> list[MatchedFile]:
    """Sort by student, assignment and time; what can't be put in an order joins the rest."""
    whose: dict[tuple[str, str], list[MatchedFile]] = defaultdict(list)
    for each in hand_ins:
        whose[each.student_id, each.assignment].append(each)
    ordered = []
    for (student, assignment), several in sorted(whose.items()):
        times = {each.handed_in for each in several}
        if len(times) == len(several) and (None not in times or len(several) == 1):
            ordered += sorted(several, key=lambda each: each.handed_in or datetime.min)
            continue
        if _all_alike(several):
            ordered.append(several[0])
            rest += [
                UntakenFile(each.notebook, 'the same again', matters=False) for each in several[1:]
            ]
            continue
        others = f'one of {len(several)} notebooks for {assignment} by {student}'
        reason = f'{others}, and nothing tells which is the latest'
        rest += [UntakenFile(each.notebook, reason) for each in several]
    return ordered


def _all_alike(several: list[MatchedFile]) -> bool:
    """Whether they hold the same; not where that can't be read."""
    try:
        return len({_content(each) for each in several}) == 1
    except OSError:
        return False  # each of them is left to a person, with its path


def _content(each: MatchedFile) -> bytes:
    """Return a digest of the files of a submission."""
    digest = sha256()
    for name, path in [('', each.notebook.readable), *sorted(each.extra.items())]:
        digest.update(f'{name} {path.stat().st_size} '.encode())
        digest.update(path.read_bytes())
    return digest.digest()
