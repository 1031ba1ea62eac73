"""ROS packages in what was collected: folders or archives beside the notebook that needs them."""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path, PurePosixPath

from my_robot_basics.session import package_files

from grader.collect.archive_entries import ARCHIVE
from grader.collect.incoming import Incoming, is_notebook
from grader.collect.owners import foreign_file_reason
from grader.collect.platforms import label_in
from grader.collect.uploads import package_in

NO_NOTEBOOK = 'it is part of a package that is beside no notebook of one student that asks for it'


@dataclass(frozen=True)
class IncomingPackage:
    """A folder that may be a package, or an archive of one."""

    name: str
    at: tuple[str, ...]
    """The path of the folder that contains it."""
    number: str
    """The number that a platform gave its student, if the package is a separate upload."""
    members: list[Incoming]
    root: tuple[str, ...]
    """The path of the package's own folder."""

    @property
    def key(self) -> tuple:
        """Return a key that the package shares with its notebook."""
        return (self.name, self.at, self.number)


@dataclass
class ChosenFiles:
    """Which files of a package are taken, and which are not."""

    taken: dict[str, Path] = field(default_factory=dict)
    """By path in the submission: 'arm_player/setup.py'."""
    changed: list[datetime] = field(default_factory=list)
    """The change time (ctime) of each file that a student put there."""
    left: list[tuple[Incoming, str]] = field(default_factory=list)
    problem: str = ''
    """Why no file of it is taken, or ''."""

    def clauses(self, package: str) -> list[str]:
        """Return what the student is told."""
        if self.problem:
            return [f'the package `{package}` was not collected: {self.problem}']
        told = [package_files.left_out_clause(each.path, reason) for each, reason in self.left]
        start = f'of the package `{package}` was not collected: '
        return [start + clause for clause in package_files.first_clauses(told)]


def split_packages(
    found: Sequence[Incoming], packages: Collection[str]
) -> tuple[list[Incoming], list[IncomingPackage]]:
    """Separate packages from other files: a package is a folder of such a name beside a notebook.

    A notebook inside a package is not a submission.
    """
    notebooks = [each for each in found if is_notebook(each)]
    folders = {each.parts[:-1] for each in notebooks}
    rest, inside = [], defaultdict(list)
    for each in found:
        at = _root_of(each, packages, folders)
        if at is None:
            rest.append(each)
        else:
            inside[each.parts[: at + 1]].append(each)
    return rest, [_package(path, members) for path, members in inside.items()]


def number_of(notebook: Incoming) -> str:
    """Return the platform's number in a notebook's name, if it is a separate upload; else ''."""
    label = label_in(notebook.parts[-1])
    return label.number if label else ''


def choose_files(package: IncomingPackage, student: str) -> ChosenFiles:
    """Choose the files of a student's package: the same that a build in the notebook uses."""
    chosen = ChosenFiles()
    files: dict[str, Incoming] = {}
    for each in package.members:
        parts = each.parts[len(package.root) :]
        if reason := _left_out_reason(each, parts, package.root) or foreign_file_reason(
            each, student
        ):
            chosen.left.append((each, reason))
            continue
        if former := files.get('/'.join(parts)):
            chosen.left.append((former, 'it is there twice: the last one counts'))
        files['/'.join(parts)] = each
    folders = {str(above) for name in files for above in PurePosixPath(name).parents}
    for name in folders & {*files}:
        chosen.left.append((files.pop(name), 'a folder has the same name'))
    sizes = {name: each.readable.stat().st_size for name, each in files.items()}
    chosen.problem = package_files.reason_too_large(sizes)
    if chosen.problem:
        chosen.left += [(each, chosen.problem) for each in files.values()]
    else:
        chosen.taken = {f'{package.name}/{n}': each.readable for n, each in files.items()}
        chosen.changed = [each.changed for each in files.values() if each.changed]
    return chosen


def needs_attention(reason: str) -> bool:
    """Whether a person should look at a file that was left out: not if a program made it."""
    return not reason.startswith(('hidden', 'left behind', 'made by'))


def _root_of(
    each: Incoming, packages: Collection[str], folders: Collection[tuple[str, ...]]
) -> int | None:
    for at, part in enumerate(each.parts[:-1]):
        if package_in(part) in packages and each.parts[:at] in folders:
            return at
    return None


def _package(path: tuple[str, ...], members: list[Incoming]) -> IncomingPackage:
    *at, top = path
    name, label = package_in(top), label_in(top)
    folders = {each.parts[:-1] for each in members if each.parts[-1] == 'package.xml'}
    root: tuple[str, ...] = path
    if ARCHIVE.search(top) and path not in folders:
        root = (*path, name)  # most programs put the folder itself into the archive
        # or those above it, too: ros_ws/src/arm_player
        deeper = [each for each in folders if each[-1] == name]
        if root not in folders and len(deeper) == 1:
            [root] = deeper
    return IncomingPackage(name, tuple(at), label.number if label else '', members, root)


def _left_out_reason(each: Incoming, parts: tuple[str, ...], root: tuple[str, ...]) -> str:
    if each.problem:
        return each.problem
    if not parts or each.parts[: len(root)] != root:
        return 'it is beside the package in its archive'
    if any(ARCHIVE.search(part) for part in parts[:-1]):
        return 'it is in an archive: unpack that in the folder of the package'
    if each.file is None:
        return 'it could not be read'
    return package_files.reason_left_out(parts)


def group_by_key(found: Sequence[IncomingPackage]) -> Mapping[tuple, list[IncomingPackage]]:
    """Return packages by the key that they share with a notebook."""
    by_key: dict[tuple, list[IncomingPackage]] = defaultdict(list)
    for each in found:
        by_key[each.key].append(each)
    return by_key


def first_package_of(student: str, found: Sequence[IncomingPackage]) -> IncomingPackage | None:
    """Return the first package with a file that may be the student's; else the first, if any."""
    theirs = (p for p in found if not all(foreign_file_reason(e, student) for e in p.members))
    return next(theirs, next(iter(found), None))
