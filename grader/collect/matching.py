"""Match notebooks to student, assignment and time, by their paths and names."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from hashlib import sha256
from pathlib import Path

from grader.collect.companions import Companions, find_companions
from grader.collect.incoming import Incoming, is_notebook
from grader.collect.left_over import Beside, left_beside, left_of_packages
from grader.collect.naming import Owner
from grader.collect.owners import find_owners, late_remark
from grader.collect.package_folders import group_by_key, split_packages
from grader.collect.platforms import PlatformLabel
from grader.collect.untaken import UntakenFile, UntakenReasons
from grader.collect.uploads import is_wanted


@dataclass(frozen=True)
class MatchedFile:
    """One submission of one student for one assignment, as it came in."""

    student_id: str
    assignment: str
    notebook: Incoming
    extra: dict[str, Path] = field(default_factory=dict)
    """The student's Python files beside it, by name, and those of packages, by path."""
    handed_in: datetime | None = None
    """In UTC; None if nothing says when."""
    label: PlatformLabel | None = None
    """What a course platform wrote about the student into a name."""
    remark: str = ''
    """What a person may want to check, although it was taken."""
    secret: Path | None = None
    """nbgrader's secret file, which determines the name of the feedback page in the exchange."""
    left_out: tuple[str, ...] = ()
    """What the student is told about files that were not taken."""


def match(
    found: Sequence[Incoming],
    assignments: Collection[str],
    *,
    packages: Mapping[str, Iterable[str]] | None = None,
    students: Iterable[str] = (),
    file_times: bool = False,
    is_all: bool = True,
) -> tuple[list[MatchedFile], list[UntakenFile]]:
    """Split what came in into submissions, sorted by time for each student, and untaken files.

    `packages` are the ROS packages that are handed in with each assignment, `students` those who
    are known already. If nothing else says when a file was handed in, `file_times` uses its
    modification time. If `found` `is_all` that came in, students without a notebook are named.
    """
    asked_for = {name: tuple(several) for name, several in (packages or {}).items()}
    found, folders = split_packages(
        found, {each for several in asked_for.values() for each in several}
    )
    beside, unwanted = _split_by_folder(found)
    owners, remarks, problems = find_owners(found, assignments, students)
    by_key = group_by_key(folders)
    companions = {
        notebook: find_companions(
            notebook,
            owner,
            beside=beside[notebook.parts[:-1]],
            asked_for=asked_for.get(owner.assignment, ()),
            packages=by_key,
        )
        for notebook, owner in owners.items()
    }
    hand_ins = [
        _match(notebook, owners[notebook], with_it, remarks[notebook], file_times=file_times)
        for notebook, with_it in companions.items()
    ]
    broken = {each: each.problem for each in found if each.problem}
    reasons = UntakenReasons(owners, assignments, (*problems, *broken), is_all=is_all)
    rest = [UntakenFile(each, why) for each, why in (*broken.items(), *problems.items())]
    rest += map(reasons.unwanted, unwanted)
    rest += left_of_packages(folders, companions.values())
    rest += left_beside(beside, owners, companions.values(), reasons)
    return _sort_hand_ins(hand_ins, rest), rest


def _split_by_folder(found: Iterable[Incoming]) -> tuple[Beside, list[Incoming]]:
    """Return readable files that are no notebooks: wanted ones by folder, and all others."""
    beside: Beside = defaultdict(dict)
    unwanted = []
    for each in (each for each in found if not each.problem and not is_notebook(each)):
        if is_wanted(each.parts[-1:]):
            beside[each.parts[:-1]][each.parts[-1]] = each
        else:
            unwanted.append(each)
    return beside, unwanted


def _match(
    notebook: Incoming, owner: Owner, with_it: Companions, remark: str, *, file_times: bool
) -> MatchedFile:
    handed_in = _submission_time(notebook, owner, with_it, file_times=file_times)
    late = '' if handed_in else late_remark(notebook, owner)
    return MatchedFile(
        student_id=owner.student_id,
        assignment=owner.assignment,
        notebook=notebook,
        extra=with_it.extra_files(),
        handed_in=handed_in,
        label=owner.label,
        remark='; '.join(filter(None, (_empty_remark(notebook), late, remark))),
        secret=with_it.secret.readable if with_it.secret else None,
        left_out=with_it.left_out(),
    )


def _empty_remark(notebook: Incoming) -> str:
    """Return a remark if a file is empty: perhaps it was not saved, copied or unpacked whole."""
    try:
        is_empty = notebook.readable.stat().st_size == 0
    except OSError:
        return ''  # it is listed where it is copied
    return 'its file is empty: get it once more, or ask for it' if is_empty else ''


def _submission_time(
    notebook: Incoming, owner: Owner, with_it: Companions, *, file_times: bool
) -> datetime | None:
    """Return when it was handed in; None if nothing says so.

    If students write into the folder, names and `timestamp.txt` could claim any time, and files
    could be edited later: then only the files' change times (ctime) count.
    """
    if notebook.changed:
        return max([notebook.changed, *with_it.change_times()])
    told = owner.handed_in or with_it.timestamp()
    claimed = notebook.modified if file_times else None
    return max([*with_it.change_times(), *([told] if told else [])], default=claimed)


def _sort_hand_ins(hand_ins: list[MatchedFile], rest: list[UntakenFile]) -> list[MatchedFile]:
    """Sort by student, assignment and time; submissions in no clear order are added to `rest`."""
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
                UntakenFile(each.notebook, 'the same again', needs_attention=False)
                for each in several[1:]
            ]
            continue
        others = f'one of {len(several)} notebooks for {assignment} by {student}'
        reason = (
            f'{others}, and nothing shows which is the latest: collect a folder with only the one '
            "to grade, or use --file-times if the files' times are right"
        )
        rest += [UntakenFile(each.notebook, reason) for each in several]
    return ordered


def _all_alike(several: list[MatchedFile]) -> bool:
    """Whether all have the same content; False if a file can't be read."""
    try:
        return len({_content(each) for each in several}) == 1
    except OSError:
        return False  # then each of them is listed as not taken, with its path


def _content(each: MatchedFile) -> bytes:
    """Return a digest of the files of a submission."""
    digest = sha256()
    for name, path in [('', each.notebook.readable), *sorted(each.extra.items())]:
        digest.update(f'{name} {path.stat().st_size} '.encode())
        digest.update(path.read_bytes())
    return digest.digest()
